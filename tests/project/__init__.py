"""Tests of the project: its packages and its habits."""
