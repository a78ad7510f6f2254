"""Vehicle data: MuJoCo shape (`gtmax.xml`) and parameters with sources (`gtmax.toml`)."""

from pathlib import Path

FOLDER = Path(__file__).parent
