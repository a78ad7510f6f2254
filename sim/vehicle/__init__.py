"""The rotorcraft: rotor, rigid body, trim, linearisation."""
