"""Flight logs made of other programs' logs."""

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from flight.errors import BadFileError, FlightError
from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.autopilot_messages import AutopilotMessage
from flightlog.consistency import LONGEST_NAME, check_log_consistency
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.series import Series
from runtime.version import VERSION

from .motion.resets import Break

UNKNOWN = "not known"

_PIECE = 1 << 20

MANY = 0.01
"""Share of samples left out above which an import is one with loss."""


@dataclass(frozen=True, slots=True)
class LeftOut:
    """Samples of a file that are left out, and the reasons."""

    sample: str
    count: int
    total: int
    reasons: str

    @classmethod
    def of(cls, sample: str, total: int, reasons: Mapping[str, int]) -> tuple["LeftOut", ...]:
        """Returns the samples left out by reason; none without any."""
        count = sum(reasons.values())
        told = ", ".join(f"{number} {reason}" for reason, number in reasons.items())
        return (cls(sample, count, total, told),) if count else ()

    @property
    def many(self) -> bool:
        """True if they are more than can be passed over."""
        return self.count > MANY * self.total

    @property
    def sentence(self) -> str:
        """The numbers in words."""
        return f"{self.count} of {self.total} {self.sample}s left out: {self.reasons}"


@dataclass(frozen=True, slots=True, eq=False)
class ExternalLog:
    """File of another program."""

    path: Path

    def content(self) -> bytes:
        """Returns the bytes of the file.

        Raises:
            BadFileError: the file cannot be read.
        """
        try:
            return self.path.read_bytes()
        except OSError as error:
            raise BadFileError(self.path, f"cannot be read: {error.strerror or error}") from None

    def fingerprint(self) -> str:
        """Returns the SHA-256 of the file, or of a folder's files."""
        files = sorted(self.path.iterdir()) if self.path.is_dir() else [self.path]
        whole = hashlib.sha256()
        for file in files:
            with file.open("rb") as stream:
                while part := stream.read(_PIECE):
                    whole.update(part)
        return whole.hexdigest()

    def log(
        self,
        series: Iterable[Series],
        *,
        vehicle: str = UNKNOWN,
        outcome: str = "completed",
        provenance: Mapping[str, object],
        autopilot_messages: Sequence[AutopilotMessage] = (),
        breaks: Sequence[Break] = (),
        left_out: Sequence[LeftOut] = (),
    ) -> FlightLog:
        """Returns the flight log, with times from the first state.

        Args:
            series: series on one clock; samples before the first state or after the last are dropped.
            vehicle: name of the vehicle.
            outcome: outcome of the flight or of the import.
            provenance: origin of the numbers, for the attachment.
            autopilot_messages: autopilot messages on the clock of the series.
            breaks: resets and jumps on the clock of the series.
            left_out: samples of the file that are not in the series.

        Raises:
            BadFileError: the series hold no motion.
        """
        try:
            cut, start, duration = _start_at_first_state({part.topic.name: part for part in series})
        except FlightError as error:
            raise BadFileError(self.path, str(error)) from None
        messages = [
            asdict(replace(message, time=round(message.time - start, 6))) for message in autopilot_messages
        ]
        source = {"file": self.path.name, "sha256": self.fingerprint(), **provenance}
        inside = [each for each in breaks if start <= each.time <= start + duration]
        if inside:
            source["breaks"] = [
                {
                    "start": round(max(each.start - start, 0.0), 6),
                    "time": round(each.time - start, 6),
                    "reason": each.reason,
                }
                for each in inside
            ]
        if left_out:
            source["left out"] = [each.sentence for each in left_out]
        if outcome == "completed" and any(each.many for each in left_out):
            outcome = "; ".join(each.sentence for each in left_out if each.many)
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
        log = FlightLog(header, cut, {IMPORT_ATTACHMENT: json.dumps(source, indent=1).encode()})
        try:
            check_log_consistency(log)
        except ValueError as error:
            raise BadFileError(self.path, f"cannot become a flight log: {error}") from None
        return log


def _printable(text: str) -> str:
    return "".join(letter for letter in text if letter.isprintable())[:LONGEST_NAME]


def _start_at_first_state(series: Mapping[str, Series]) -> tuple[dict[str, Series], float, float]:
    """Returns the series from the first state, its time, the duration."""
    whole = FlightLog(FlightHeader("import", "", "", "", 0, "", "", ""), series, {})
    start, end = float(whole.motion.time[0]), whole.duration
    cut = {}
    for name, part in series.items():
        inside = (part.time >= start) & (part.time <= end)
        if inside.any():
            cut[name] = Series(part.topic, part.time[inside] - start, part.values[inside])
    return cut, start, end - start
