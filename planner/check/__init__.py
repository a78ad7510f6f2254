"""Checks of plans and certificates; imports nothing else of the planner."""
