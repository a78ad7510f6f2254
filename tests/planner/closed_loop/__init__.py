"""Tests of planner.closed_loop."""
