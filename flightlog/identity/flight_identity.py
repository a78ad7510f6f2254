"""Identity of a flight: its inputs and their hashes."""

from collections.abc import Mapping
from dataclasses import asdict
from hashlib import sha256

from flightlog.attachment_names import (
    LIBRARY_ATTACHMENT,
    MISSION_ATTACHMENT,
    MODEL_ATTACHMENT,
    SPECIFICATION_ATTACHMENT,
    VEHICLE_ATTACHMENT,
)
from flightlog.header import FlightHeader

_INPUTS = (
    SPECIFICATION_ATTACHMENT,
    LIBRARY_ATTACHMENT,
    VEHICLE_ATTACHMENT,
    MODEL_ATTACHMENT,
    MISSION_ATTACHMENT,
)


def flight_identity(header: FlightHeader, attachments: Mapping[str, bytes]) -> dict[str, str]:
    """Returns a flight's inputs and their hashes, most informative first.

    Compilation of the vehicle's expressions is not part of it, because it does not change the bits; nor is
    the outcome.
    """
    known = {name: str(value) for name, value in asdict(header).items() if name not in {"outcome", "backend"}}
    known |= {"arithmetic": header.arithmetic, "search": header.search_backend}
    digests = {name: sha256(attachments[name]).hexdigest() for name in _INPUTS if name in attachments}
    return {**known, **digests}


def identity_difference(expected: Mapping[str, str], found: Mapping[str, str]) -> str | None:
    """Returns the first difference of two identities; None if equal."""
    for name in dict.fromkeys((*expected, *found)):
        wanted, got = expected.get(name, "none"), found.get(name, "none")
        if wanted != got:
            return f"expected {name} {wanted}, got {got}"
    return None
