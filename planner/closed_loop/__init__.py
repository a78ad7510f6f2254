"""The receding horizon, for any implementation of the Vehicle protocol."""
