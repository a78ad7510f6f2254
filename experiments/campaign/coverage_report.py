"""Report of a library's coverage for `identify` and `regenerate`."""

from collections.abc import Iterable

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.plural import plural
from identification.segmentation.flight_evidence import NOMINAL, FlightEvidence

COVERAGE_TOO_LOW = 1
"""Exit code for a primitive below the requested coverage."""


def split_by_kind(
    flights: Iterable[FlightEvidence],
) -> tuple[list[FlightEvidence], list[FlightEvidence]]:
    """Returns the flights for the bounds and those for the values."""
    everyone = list(flights)
    nominal = [flight for flight in everyone if flight.header.kind == NOMINAL]
    return [flight for flight in everyone if flight.header.kind != NOMINAL], nominal


def weaker_claims(library: Library, coverage: float | None) -> list[str]:
    """Returns messages on primitives below the requested coverage.

    Raises:
        FlightError: the coverage is not between 0 and 1.
    """
    if coverage is None:
        return []
    if not 0 < coverage < 1:
        raise FlightError(f"--coverage must be between 0 and 1, got {coverage}")
    parts = [("trim", trim.id, trim.statistics) for trim in library.trims]
    parts += [("maneuver", row.id, row.statistics) for row in library.maneuvers]
    return [
        f"{kind} {number}: expected coverage >= {coverage:g}, got {found.coverage:.3f} from "
        f"{plural(found.samples, 'flight')}, {found.discarded} of them lost or not settled"
        for kind, number, found in parts
        if found is not None and found.coverage < coverage
    ]
