"""Rotorcraft: rotor, rigid body, trim and linearisation."""
