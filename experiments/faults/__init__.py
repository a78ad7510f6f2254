"""Fault matrix: flights with faults, and their outcomes."""
