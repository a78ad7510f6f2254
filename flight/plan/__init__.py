"""A plan, its file format and its certificate."""
