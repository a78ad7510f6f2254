"""Shipped missions, sequences, campaigns and fault matrices, and how they are found by name."""
