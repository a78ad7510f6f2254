"""Segmentation of flights into primitives, by commands or by motion."""
