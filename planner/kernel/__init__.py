"""The exact search in C: sources, build and input tables."""
