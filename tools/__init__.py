"""Makers of the files that are shipped."""
