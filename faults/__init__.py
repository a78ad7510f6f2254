"""Where the shipped fault matrices are."""

from pathlib import Path

FOLDER = Path(__file__).parent
