"""MCAP files of flight logs: writing, reading, recovery."""
