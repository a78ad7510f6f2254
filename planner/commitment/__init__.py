"""Search for one set of coasting times over a gamma interval."""
