"""Fingerprint of a flight: the hash of its content."""

import json
from dataclasses import asdict, fields
from hashlib import sha256

from flightlog.header import FlightHeader
from flightlog.log import FlightLog

_LATER_FIELDS = frozenset({"air", "vehicles", "drawn", "sensors"})


def fingerprint(log: FlightLog) -> str:
    """Returns the SHA-256 of a log's content, independent of computation.

    Compiled and interpreted back-ends give the same bits (`sim.loop.backend`), so a flight has one
    fingerprint with and without a compiler. Changes of code that change no flight, and the packing of the
    file, do not change it.
    """
    # Logs of older versions lack these.
    later = {field.name: field.default for field in fields(FlightHeader) if field.name in _LATER_FIELDS}
    header = {key: value for key, value in asdict(log.header).items() if later.get(key) != value}
    header |= {"backend": log.header.arithmetic, "code_version": log.header.release}
    digest = sha256(json.dumps(header, sort_keys=True).encode())
    for name, series in sorted(log.series.items()):
        digest.update(name.encode())
        digest.update(series.time.tobytes() + series.values.tobytes())
    for name, content in sorted(log.attachments.items()):
        digest.update(name.encode() + b"\0" + sha256(content).digest())
    return digest.hexdigest()
