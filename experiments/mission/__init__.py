"""Closed-loop missions: policies, flights, results and their store."""
