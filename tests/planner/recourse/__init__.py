"""Tests of the cost-to-go and the policy with feedback."""
