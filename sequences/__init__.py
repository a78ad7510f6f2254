"""Where the shipped sequences are."""

from pathlib import Path

FOLDER = Path(__file__).parent
