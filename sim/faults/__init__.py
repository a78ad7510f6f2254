"""Fault injection into vehicle, sensors, air and computer."""
