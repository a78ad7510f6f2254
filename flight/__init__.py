"""Vocabulary: units, planar motion, maneuver automaton, mission, plan."""
