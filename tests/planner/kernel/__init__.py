"""Tests of planner.kernel: every branch of the C, in at most 20 s."""
