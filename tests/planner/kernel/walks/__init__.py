"""Tests of the search over walks."""
