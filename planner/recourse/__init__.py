"""Cost-to-go of the stochastic shortest path to a goal, and its policy."""
