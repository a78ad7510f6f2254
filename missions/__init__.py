"""Where the shipped missions are."""

from pathlib import Path

FOLDER = Path(__file__).parent
