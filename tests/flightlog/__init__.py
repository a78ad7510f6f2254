"""Tests of flightlog."""
