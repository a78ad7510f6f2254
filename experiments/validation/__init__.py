"""Validation by many flights: grid, scorecards, pictures, trials."""
