"""Walks in the automaton and their kinematics."""
