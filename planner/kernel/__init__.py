"""The exact search in C: its sources, how they are compiled once, and the tables they read."""
