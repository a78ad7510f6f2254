"""Builders of logs, libraries, vehicles and file systems that tests share."""
