"""Processes, files, the compiler and versions: what any program needs, and nothing of flight."""
