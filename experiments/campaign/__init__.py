"""Identification campaigns: flown, evidence gathered, coverage claims forecast and tested."""
