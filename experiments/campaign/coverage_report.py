"""What `identify` and `regenerate` say of a library's claims, and which flights gave what."""

from collections.abc import Iterable

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.plural import plural
from identification.segmentation.flight_evidence import NOMINAL, FlightEvidence

COVERAGE_TOO_LOW = 1
"""Exit code where a primitive claims less than was asked for."""


def split_by_kind(
    flights: Iterable[FlightEvidence],
) -> tuple[list[FlightEvidence], list[FlightEvidence]]:
    """Returns the flights that give the bounds, and those that were flown to give the values."""
    everyone = list(flights)
    nominal = [flight for flight in everyone if flight.header.kind == NOMINAL]
    return [flight for flight in everyone if flight.header.kind != NOMINAL], nominal


def weaker_claims(library: Library, coverage: float | None) -> list[str]:
    """Returns, for people, the primitives that claim less than a coverage asked for.

    Raises:
        FlightError: the coverage is no share.
    """
    if coverage is None:
        return []
    if not 0 < coverage < 1:
        raise FlightError(f"--coverage must be between 0 and 1, got {coverage}")
    parts = [("trim", trim.id, trim.statistics) for trim in library.trims]
    parts += [("maneuver", row.id, row.statistics) for row in library.maneuvers]
    return [
        f"{kind} {number} claims {found.coverage:.3f}, less than {coverage:g}: "
        f"{plural(found.samples, 'flight')}, {found.discarded} of them lost or not settled"
        for kind, number, found in parts
        if found is not None and found.coverage < coverage
    ]
