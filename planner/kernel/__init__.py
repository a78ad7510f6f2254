"""Exact search in C.

`coasting` solves one walk (entry: `units.c`), `walks` searches over walks (entry: `search.c`); `exact.py` is
their one face for Python, `build.py` compiles them.
"""
