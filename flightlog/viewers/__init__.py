"""Channels of a flight log that common viewers draw."""
