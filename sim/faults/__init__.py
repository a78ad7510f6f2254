"""Faults injected into vehicle, sensors, air and computer."""
