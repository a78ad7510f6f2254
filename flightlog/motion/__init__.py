"""Continuity of a logged motion."""
