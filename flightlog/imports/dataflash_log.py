"""Import of ArduPilot's DataFlash logs."""

from pathlib import Path

from flight.errors import BadFileError
from flightlog.log import FlightLog


def read_dataflash_log(path: Path, *, part: int | None = None) -> FlightLog:
    """Reads a DataFlash log."""
    raise BadFileError(path, f"DataFlash not read, part {part}")
