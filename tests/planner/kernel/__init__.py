"""Tests of planner.kernel."""
