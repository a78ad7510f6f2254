"""Deviations, bounds and coverage of observed primitives."""
