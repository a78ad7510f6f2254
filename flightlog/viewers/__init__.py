"""Channels of a flight log for common viewers."""
