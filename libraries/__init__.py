"""Folder of the shipped libraries."""

from pathlib import Path

FOLDER = Path(__file__).parent
