"""Primitives interpolated between flown ones, with coverage claims."""
