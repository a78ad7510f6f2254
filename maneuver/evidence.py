"""Logs, read and cut into primitives: what `identify`, `regenerate` and `demo` share; knows no simulator."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

from flight.fingerprint import fingerprint
from flight.log_file import read_log
from identification.identify import FlightEvidence, evidence

from .progress import shown


def gather_evidence(paths: Sequence[Path], *, executor: Executor) -> list[FlightEvidence]:
    """Reads logs and cuts them into primitives.

    Raises:
        FlightError: a log is broken or lacks something.
    """
    return list(shown(executor.map(_evidence_of, paths), total=len(paths), what="identifying"))


def _evidence_of(path: Path) -> FlightEvidence:
    log = read_log(path)
    return evidence(log, name=str(path), sha256=fingerprint(log))
