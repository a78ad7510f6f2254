"""Tests of planner.independent_errors."""
