"""Figures that sum up a flight: tiles, tracking, bounds, control limits."""
