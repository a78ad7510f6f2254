"""Fingerprints of a flight: hashes of its content, exact or rounded."""

import json
from dataclasses import asdict, fields
from hashlib import sha256

import numpy as np
from jaxtyping import Float

from flightlog.attachment_names import VEHICLE_ATTACHMENT
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.series import Series

from .flight_identity import flight_identity

# Significant digits, relative to a field's largest value; what is smaller than the floor is zero.
_DIGITS, _FLOOR = 6, 1e-9

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


def rounded_fingerprint(log: FlightLog) -> str:
    """Returns the SHA-256 of a flight to six digits.

    It is equal on every processor: they differ in the last bits of sums and of elementary functions. The hash
    is of the flight's inputs and outcome, and of each series' length, first and last times, and first, last,
    mean and root mean square values: few enough numbers that none is likely to be at the edge of a rounding.
    """
    inputs = flight_identity(log.header, log.attachments)
    # The code's release is enough: other code that flies the same flight gives the same numbers.
    inputs |= {"code_version": log.header.release, "outcome": log.header.outcome}
    # Seed, population and model determine a drawn vehicle, whose numbers differ in last bits too.
    inputs = {name: value for name, value in inputs.items() if name not in {"drawn", VEHICLE_ATTACHMENT}}
    digest = sha256(json.dumps(inputs, sort_keys=True).encode())
    for name, series in sorted(log.series.items()):
        digest.update(json.dumps([name, len(series.time), *_summary(series)]).encode())
    return digest.hexdigest()


def _summary(series: Series) -> list[int]:
    """Returns a series' characteristic numbers as integers."""
    if not len(series.time):
        return []
    # An imported log may lack values here and there.
    values = np.where(np.isfinite(series.values), series.values, 0.0)
    largest = np.maximum(np.abs(values).max(axis=0), _FLOOR)
    rows = (values[0], values[-1], values.mean(axis=0), np.sqrt((values**2).mean(axis=0)))
    times = [round(float(time) * 1e6) for time in (series.time[0], series.time[-1])]
    return [*times, *(number for row in rows for number in _integers(row, largest))]


def _integers(row: Float[np.ndarray, "fields"], largest: Float[np.ndarray, "fields"]) -> list[int]:
    units = 10.0 ** (np.floor(np.log10(largest)) - _DIGITS + 1)
    rounded: list[int] = np.round(row / units).astype(np.int64).tolist()
    return rounded
