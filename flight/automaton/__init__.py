"""The maneuver automaton: trims, maneuvers, libraries, their statistics and file format."""
