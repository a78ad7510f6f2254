"""Certificates of plans: dual bounds, multipliers, branching trees."""
