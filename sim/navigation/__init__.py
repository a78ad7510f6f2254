"""Sensors and the navigation filter."""
