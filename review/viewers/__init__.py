"""Layouts for other viewers: Foxglove and Lichtblick, Rerun."""
