"""Simulated helicopter: vehicle, wind, navigation, controller, flight loop and campaigns."""
