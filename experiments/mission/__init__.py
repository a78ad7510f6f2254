"""Missions flown in closed loop: policies by name, flights, results and their store."""
