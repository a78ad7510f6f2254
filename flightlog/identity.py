"""Which flight a log is of: all of it that is known before the flight, so that a log says whose it is."""

from collections.abc import Mapping
from dataclasses import asdict
from hashlib import sha256

from .attachment_names import (
    LIBRARY_ATTACHMENT,
    MISSION_ATTACHMENT,
    MODEL_ATTACHMENT,
    SPECIFICATION_ATTACHMENT,
    VEHICLE_ATTACHMENT,
)
from .header import FlightHeader

_INPUTS = (
    SPECIFICATION_ATTACHMENT,
    LIBRARY_ATTACHMENT,
    VEHICLE_ATTACHMENT,
    MODEL_ATTACHMENT,
    MISSION_ATTACHMENT,
)


def flight_identity(header: FlightHeader, attachments: Mapping[str, bytes]) -> dict[str, str]:
    """Returns what makes a flight this one: names and digests, the telling ones first.

    Whether the vehicle's expressions were compiled is no part of it, because both ways give the same bits;
    nor is what came of it.
    """
    known = {name: str(value) for name, value in asdict(header).items() if name not in {"outcome", "backend"}}
    known |= {"arithmetic": header.arithmetic, "search": header.search_backend}
    digests = {name: sha256(attachments[name]).hexdigest() for name in _INPUTS if name in attachments}
    return {**known, **digests}


def identity_difference(expected: Mapping[str, str], found: Mapping[str, str]) -> str | None:
    """Returns the first thing in which two flights differ, in words; None where they are the same."""
    for name in dict.fromkeys((*expected, *found)):
        wanted, got = expected.get(name, "none"), found.get(name, "none")
        if wanted != got:
            return f"expected {name} {wanted}, got {got}"
    return None
