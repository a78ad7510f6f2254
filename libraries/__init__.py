"""Where the shipped libraries are."""

from pathlib import Path

FOLDER = Path(__file__).parent
