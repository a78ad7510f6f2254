"""Identification campaigns: flights, evidence, forecasts, coverage tests."""
