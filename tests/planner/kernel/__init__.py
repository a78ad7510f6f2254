"""Tests of planner.kernel; mark `kernel` for the C code."""
