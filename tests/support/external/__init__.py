"""Files of other programs, of a circle in closed form."""
