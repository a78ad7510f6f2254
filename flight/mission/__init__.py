"""Inputs of a flight: mission and goal, sequence, campaign, wind change, fault."""
