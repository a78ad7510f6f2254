"""What other viewers need to show a log well: a layout for Foxglove and Lichtblick, a blueprint for Rerun."""
