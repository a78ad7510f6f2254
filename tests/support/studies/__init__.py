"""Harnesses of the studies: their quick forms are tests, their large ones tests marked slow."""
