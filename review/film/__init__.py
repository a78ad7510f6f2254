"""Films of flights, rendered from the log."""
