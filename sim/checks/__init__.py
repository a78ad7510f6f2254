"""Checks of physics, margins and numerics that `maneuver verify` prints."""
