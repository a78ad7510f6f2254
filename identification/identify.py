"""From flight logs to a motion-primitive library; reads nothing but the logs."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from flight.errors import FlightError
from flight.library import Library
from flight.library_file import library_text
from flight.log import FlightHeader, FlightLog

from .deviations import identified_maneuver, identified_trim
from .segmentation import CoastSegment, ManeuverSegment, Segments, segment


class InconsistentLogsError(FlightError):
    """Logs that were not flown alike cannot make one library."""


class NeverFlownError(FlightError):
    """No log shows a primitive of the automaton."""


@dataclass(frozen=True, slots=True)
class FlightEvidence:
    """What identification keeps of one log.

    Attributes:
        name: what to call the log in an error.
        sha256: of what the log holds (`flight.fingerprint`), as hexadecimal digits.
        header: the log's header.
        library: the library flown with.
        segments: its primitives.
    """

    name: str
    sha256: str
    header: FlightHeader
    library: Library
    segments: Segments


def evidence(log: FlightLog, *, name: str, sha256: str) -> FlightEvidence:
    """Returns what identification keeps of a log.

    Raises:
        FlightError: the log lacks something; its text begins with the log's name.
    """
    try:
        return FlightEvidence(name, sha256, log.header, log.library(), segment(log))
    except FlightError as error:
        raise FlightError(f"{name}: {error}") from None


def identify(
    flights: Iterable[FlightEvidence],
    *,
    name: str,
    confidence: float = 0.95,
    campaign: Mapping[str, Any] | None = None,
) -> Library:
    """Returns the library that the flights show.

    Values are commanded velocities for trims and means for maneuvers; errors are the largest deviations,
    signed by the convention (thesis, 3.2.6). The order of the flights does not matter.

    Args:
        flights: one for each log.
        name: of the library.
        confidence: of the coverage that is claimed for each primitive.
        campaign: what is known of how the flights were ordered, for the provenance; plain JSON values.

    Raises:
        InconsistentLogsError: there are none, or they differ in vehicle, wind or what was to be flown.
        NeverFlownError: a trim or maneuver of the automaton occurs in no log.
    """
    ordered = sorted(flights, key=lambda flight: (flight.header.seed, flight.sha256))
    _refuse_inconsistent(ordered)
    flown = ordered[0].library
    header = ordered[0].header
    trims = tuple(identified_trim(trim, _coasts(ordered, trim.id), confidence) for trim in flown.trims)
    maneuvers = tuple(
        identified_maneuver(
            maneuver,
            _performances(ordered, maneuver.id),
            left=flown.trim(maneuver.from_trim),
            reached=flown.trim(maneuver.to_trim),
            confidence=confidence,
        )
        for maneuver in flown.maneuvers
    )
    return Library(
        name=name,
        description=(
            f"Identified from {len(ordered)} simulated flights in wind class {header.wind}; "
            "errors are the largest deviations of the true motion."
        ),
        vehicle=header.vehicle,
        trims=trims,
        maneuvers=maneuvers,
        conditions=replace(
            flown.conditions,
            wind=header.wind,
            trim_error_kind="instantaneous",
            coasting_range=_coasting_range(ordered),
        ),
        provenance=_provenance(ordered, confidence, campaign),
    )


def _refuse_inconsistent(flights: list[FlightEvidence]) -> None:
    if not flights:
        raise InconsistentLogsError("expected flight logs, got none")
    first = flights[0]
    seen: dict[str, str] = {}
    for flight in flights:
        if flight.sha256 in seen:
            raise InconsistentLogsError(f"{flight.name} is the same flight as {seen[flight.sha256]}")
        seen[flight.sha256] = flight.name
        for what in ("vehicle", "model_hash", "wind", "code_version", "arithmetic"):
            expected, got = getattr(first.header, what), getattr(flight.header, what)
            if got != expected:
                raise InconsistentLogsError(
                    f"{flight.name}: {what} is {got}, in {first.name} it is {expected}"
                )
        if library_text(flight.library) != library_text(first.library):
            raise InconsistentLogsError(f"{flight.name}: was flown with another library than {first.name}")


def _coasts(flights: list[FlightEvidence], trim: int) -> list[list[CoastSegment]]:
    """Returns the coasts in a trim, flight by flight, without the flights that never held it."""
    by_flight = [[coast for coast in flight.segments.coasts if coast.trim == trim] for flight in flights]
    held = [coasts for coasts in by_flight if coasts]
    if not held:
        raise NeverFlownError(f"trim {trim} is held in none of the {len(flights)} logs")
    return held


def _performances(flights: list[FlightEvidence], maneuver: int) -> list[list[ManeuverSegment]]:
    """Returns the performances of a maneuver, flight by flight, without the flights that lack it."""
    by_flight = [
        [segment for segment in flight.segments.maneuvers if segment.id == maneuver] for flight in flights
    ]
    performed = [segments for segments in by_flight if segments]
    if not performed:
        raise NeverFlownError(f"maneuver {maneuver} is performed in none of the {len(flights)} logs")
    return performed


def _coasting_range(flights: list[FlightEvidence]) -> tuple[float, float]:
    durations = [coast.duration for flight in flights for coast in flight.segments.coasts]
    return min(durations), max(durations)


def _provenance(
    flights: list[FlightEvidence], confidence: float, campaign: Mapping[str, Any] | None
) -> dict[str, Any]:
    header = flights[0].header
    return {
        "method": "largest deviations of the true motion over flights, maneuvers by command change",
        "confidence": confidence,
        "model_hash": header.model_hash,
        "code_version": header.code_version,
        "backend": header.arithmetic,
        **({} if campaign is None else {"campaign": dict(campaign)}),
        "lost": sorted(flight.header.seed for flight in flights if flight.header.outcome != "completed"),
        "logs_by_seed": {str(flight.header.seed): flight.sha256 for flight in flights},
    }
