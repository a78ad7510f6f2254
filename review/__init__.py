"""Reading a flight log with the eyes."""
