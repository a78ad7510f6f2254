"""The fault matrix: flights with faults, and their outcomes."""
