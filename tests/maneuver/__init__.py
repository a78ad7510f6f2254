"""Tests of maneuver."""
