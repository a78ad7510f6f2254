"""Tests of planner.search."""
