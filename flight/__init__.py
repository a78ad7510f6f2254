"""Vocabulary of the project: units, planar motion, and the automaton, mission and plan."""
