"""Benchmarks of flight."""
