"""Checks of physics, margins and numerics, printed by `maneuver verify`."""
