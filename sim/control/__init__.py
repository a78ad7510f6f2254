"""The velocity-tracking adaptive controller and its gains."""
