"""Velocity-tracking adaptive controller and its gains."""
