"""Units of sources that are not SI, converted on entry."""

FOOT = 0.3048
"""International foot in metres, exact by definition."""
