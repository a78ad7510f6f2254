"""Measurements that print ratios from one run; no timed tests."""
