"""Tests of planner.kernel; the mark `kernel` selects those of the C."""
