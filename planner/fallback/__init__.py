"""The exact search in Python, for machines without a compiler."""
