"""Minimum-time motion plans in the maneuver automaton, nominal and robust."""
