"""Tests of planner.policies."""
