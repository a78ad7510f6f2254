"""Summary figures of a flight: tiles, tracking, bounds, control limits."""
