"""Primitives interpolated between flown ones, with their coverage claim."""
