"""Checks of plans and certificates; independent of the rest of the planner."""
