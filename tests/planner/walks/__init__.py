"""Tests of planner.walks."""
