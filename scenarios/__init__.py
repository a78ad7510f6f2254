"""Shipped missions, sequences, campaigns and fault matrices."""
