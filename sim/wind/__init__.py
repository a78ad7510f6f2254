"""Wind classes, turbulence and gusts."""
