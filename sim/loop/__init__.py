"""Simulation loop: signals, random streams and numeric back-ends."""
