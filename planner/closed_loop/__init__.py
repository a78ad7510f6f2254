"""The receding horizon, for anything that satisfies the Vehicle protocol."""
