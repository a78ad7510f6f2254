"""Where the shipped campaigns are."""

from pathlib import Path

FOLDER = Path(__file__).parent
