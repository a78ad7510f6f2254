"""Printed tables of the thesis compared with computed ones."""
