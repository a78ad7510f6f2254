"""The simulated helicopter: vehicle, wind, navigation, controller, the flight loop and campaigns."""
