"""The vehicle as data: its shape for MuJoCo (`gtmax.xml`) and its numbers with their sources (`gtmax.toml`)."""

from pathlib import Path

FOLDER = Path(__file__).parent
