"""Flight logs made of other programs' logs."""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from flight.errors import BadFileError, FlightError
from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.autopilot_messages import AutopilotMessage
from flightlog.consistency import LONGEST_NAME
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.series import Series
from runtime.version import VERSION

UNKNOWN = "not known"


@dataclass(frozen=True, slots=True, eq=False)
class ExternalLog:
    """File of another program: path and bytes."""

    path: Path
    content: bytes

    @classmethod
    def read(cls, path: Path) -> "ExternalLog":
        """Reads a file.

        Raises:
            BadFileError: the file cannot be read.
        """
        try:
            return cls(path, path.read_bytes())
        except OSError as error:
            raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None

    def log(
        self,
        series: Iterable[Series],
        *,
        vehicle: str = UNKNOWN,
        outcome: str = "completed",
        provenance: Mapping[str, object],
        autopilot_messages: Sequence[AutopilotMessage] = (),
    ) -> FlightLog:
        """Returns the flight log, with times from the first state.

        Args:
            series: series on one clock; samples before the first state or after the last are dropped.
            vehicle: name of the vehicle.
            outcome: outcome of the flight or of the import.
            provenance: origin of the numbers, for the attachment.
            autopilot_messages: autopilot messages on the clock of the series.

        Raises:
            BadFileError: the series hold no motion.
        """
        try:
            cut, start = _start_at_first_state({part.topic.name: part for part in series})
        except FlightError as error:
            raise BadFileError(self.path, str(error)) from None
        messages = [
            asdict(replace(message, time=round(message.time - start, 6))) for message in autopilot_messages
        ]
        source = {"file": self.path.name, "sha256": hashlib.sha256(self.content).hexdigest(), **provenance}
        if messages:
            source["messages"] = messages
        unknown = {"model_hash": UNKNOWN, "wind": UNKNOWN, "backend": UNKNOWN}
        header = FlightHeader(
            **{
                "kind": "import",
                "name": _printable(self.path.stem),
                "vehicle": _printable(vehicle),
                **unknown,
            },
            seed=0,
            code_version=VERSION,
            outcome=outcome,
        )
        return FlightLog(header, cut, {IMPORT_ATTACHMENT: json.dumps(source, indent=1).encode()})


def _printable(text: str) -> str:
    return "".join(letter for letter in text if letter.isprintable())[:LONGEST_NAME]


def _start_at_first_state(series: Mapping[str, Series]) -> tuple[dict[str, Series], float]:
    """Returns the series with time 0 at the first state."""
    whole = FlightLog(FlightHeader("import", "", "", "", 0, "", "", ""), series, {})
    start, end = float(whole.motion.time[0]), whole.duration
    cut = {}
    for name, part in series.items():
        inside = (part.time >= start) & (part.time <= end)
        if inside.any():
            cut[name] = Series(part.topic, part.time[inside] - start, part.values[inside])
    return cut, start
