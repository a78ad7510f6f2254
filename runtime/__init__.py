"""Processes, files, compiler and versions; nothing about flight."""
