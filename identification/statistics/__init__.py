"""Deviations, bounds and coverage of the primitives observed."""
