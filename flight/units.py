"""Units that are not SI, as they stand in sources and are converted where they enter."""

FOOT = 0.3048
"""International foot in metres, exact by definition."""
