"""Checks of plans and certificates; imports no other room of the planner."""
