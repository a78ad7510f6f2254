"""Reading of ULogs by pyulog, within bounds."""

import io
from collections.abc import Mapping
from contextlib import redirect_stdout
from typing import Any

import numpy as np

from flight.errors import FlightError
from flightlog.autopilot_messages import AutopilotMessage

from .ulog_recovery import HEADER

Messages = Mapping[str, np.ndarray[Any, Any]]
"""Fields of a topic by name."""


def read_ulog(content: bytes) -> tuple[dict[str, Messages], dict[str, str], list[AutopilotMessage]]:
    """Returns fields by topic, the log's information, and its messages.

    Raises:
        FlightError: pyulog is not installed, or cannot read the bytes.
    """
    try:
        from pyulog import ULog
        from pyulog.exceptions import ULogException
    except ImportError:
        raise FlightError("a ULog needs the package pyulog: pip install pyulog") from None
    if len(content) <= HEADER:
        raise FlightError(f"is truncated after {len(content)} bytes, without an intact message")
    try:
        # The reader prints to the console.
        with redirect_stdout(io.StringIO()):
            log = ULog(_BoundedReader(content))
    except ULogException as error:
        raise FlightError(f"is not a ULog: {' '.join(str(error).split())}") from None
    # Relative to the log's start: microseconds of a date leave a double few digits.
    topics: dict[str, Messages] = {
        part.name: {**part.data, "timestamp": part.data["timestamp"].astype(np.int64) - log.start_timestamp}
        for part in sorted(log.data_list, key=lambda part: -part.multi_id)
    }
    known = {key: str(log.msg_info_dict[key]) for key in sorted(log.msg_info_dict)}
    messages = [
        AutopilotMessage(
            (message.timestamp - log.start_timestamp) * 1e-6,
            _level(message.log_level),
            " ".join(message.message.split()),
        )
        for message in log.logged_messages
    ]
    return topics, known, messages


def _level(level: int) -> str:
    """Returns the severity of a Linux kernel log level digit."""
    return "ERROR" if level <= ord("3") else "WARNING" if level == ord("4") else "INFO"


class _BoundedReader:
    """In-memory file that stops a reader in an endless loop.

    The ULog reader can loop on damaged files.
    """

    def __init__(self, content: bytes) -> None:
        self._stream, self._left = io.BytesIO(content), 8 * len(content) + 10**6
        self.seek, self.tell, self.close = self._stream.seek, self._stream.tell, self._stream.close

    def read(self, size: int = -1) -> bytes:
        """Returns the next bytes.

        Raises:
            EOFError: far more was read than the file holds.
        """
        part = self._stream.read(size)
        self._left -= len(part) + 16
        if self._left < 0:
            raise EOFError("endless loop of the reader")
        return part
