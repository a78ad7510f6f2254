"""The vehicle as data: shape for MuJoCo (`gtmax.xml`), numbers with their sources (`gtmax.toml`)."""

from pathlib import Path

FOLDER = Path(__file__).parent
