"""Builders of logs, libraries, vehicles and file systems for tests."""
