"""Identification of a motion-primitive library from flight logs alone."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal

from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.errors import FlightError
from identification.segmentation.flight_evidence import FlightEvidence
from identification.statistics.coast_errors import averaged_hull, duration_bins, instantaneous_hull
from identification.statistics.deviations import DurationBin, identify_maneuver, identify_trim
from identification.statistics.samples import maneuver_samples, trim_samples

TrimErrors = Literal["instantaneous", "averaged"]


class InconsistentLogsError(FlightError):
    """Logs of different conditions or automata cannot make one library."""


class NoAutomatonError(FlightError):
    """Fewer than two trims, or no maneuver, cannot be planned with."""


def identify(
    flights: Iterable[FlightEvidence],
    *,
    name: str,
    nominal: Iterable[FlightEvidence] = (),
    confidence: float = 0.95,
    trim_errors: TrimErrors = "instantaneous",
    campaign: Mapping[str, Any] | None = None,
) -> Library:
    """Identifies the library of a set of flights.

    The value of a trim is its command; the value of a maneuver is its mean over the nominal flights, or the
    middle of its extremes without nominal flights. Errors are the largest deviations over the other flights,
    signed by the convention (thesis, 3.2.6). The result does not depend on the order of the flights.

    Args:
        flights: flights for the bounds, one per log.
        name: name of the library.
        nominal: flights for the values of maneuvers.
        confidence: confidence of each primitive's coverage.
        trim_errors: definition of a trim's error: its largest deviation at any instant, or of the average
            over a coast of any duration flown (the largest of all bins, each of which the planner may use).
        campaign: specification of the campaign for the provenance; plain JSON values.

    Raises:
        InconsistentLogsError: there are none, or they differ in vehicle, wind or automaton.
        NoAutomatonError: the automaton has fewer than two trims or no maneuver.
        NeverFlownError: no log has some trim or maneuver of the automaton.
    """
    bounding, centring = _sort_flights(flights), _sort_flights(nominal)
    _check_consistency([*bounding, *centring])
    if not bounding:
        raise InconsistentLogsError("expected flight logs that give the bounds, got nominal flights alone")
    first = bounding[0]
    flown, header = first.library, first.header
    _check_automaton(flown)
    trims = _trims(bounding, trim_errors, confidence)
    maneuvers = tuple(_maneuver(row, flown, bounding, centring, confidence) for row in flown.maneuvers)
    beside = f" (values from {len(centring)} others)" if centring else ""
    return Library(
        name=name,
        description=(
            f"Identified from {len(bounding)} flights{beside} in wind class {header.wind}; "
            f"errors are the largest deviations of the {first.judged} motion."
        ),
        vehicle=header.vehicle,
        trims=trims,
        maneuvers=maneuvers,
        conditions=replace(
            flown.conditions,
            wind=header.wind,
            air=header.air or None,
            trim_error_kind=trim_errors,
            coasting_range=_coasting_range(bounding),
            vehicle_hash=header.model_hash,
            speed_range=_speed_range(flown),
            entry_trims=tuple(sorted({row.from_trim for row in flown.maneuvers})),
            vehicles=header.vehicles,
            sensors=header.sensors or None,
        ),
        provenance=_provenance(bounding, centring, confidence, campaign),
    )


def _sort_flights(flights: Iterable[FlightEvidence]) -> list[FlightEvidence]:
    return sorted(flights, key=lambda flight: (flight.header.seed, flight.sha256))


def _trims(flights: Sequence[FlightEvidence], kind: TrimErrors, confidence: float) -> tuple[Trim, ...]:
    flown = flights[0].library
    durations = [coast.duration for flight in flights for coast in flight.segments.coasts]
    bins = duration_bins(durations, flown.conditions.coasting_range) if durations else []
    hull = instantaneous_hull if kind == "instantaneous" or not bins else averaged_hull(bins[0][0])
    return tuple(
        identify_trim(
            trim,
            trim_samples(flights, trim.id, hull=hull).require(f"trim {trim.id}"),
            confidence,
            commanded=flights[0].trims_commanded,
            averaged=tuple(_bins_of(trim.id, flights, bins)),
        )
        for trim in flown.trims
    )


def _bins_of(
    trim: int, flights: Sequence[FlightEvidence], bins: Sequence[tuple[float, float]]
) -> Iterable[DurationBin]:
    for shortest, longest in bins:
        samples = trim_samples(flights, trim, hull=averaged_hull(shortest, longest))
        # A bin without a coast in this trim has no error.
        if len(samples.low):
            yield DurationBin(shortest, longest, samples)


def _maneuver(
    row: Maneuver,
    flown: Library,
    bounding: Sequence[FlightEvidence],
    centring: Sequence[FlightEvidence],
    confidence: float,
) -> Maneuver:
    required = f"maneuver {row.id}, flown to its end"
    nominal = maneuver_samples(centring, row.id).require(required) if centring else None
    return identify_maneuver(
        row,
        maneuver_samples(bounding, row.id).require(required),
        nominal=nominal,
        left=flown.trim(row.from_trim),
        reached=flown.trim(row.to_trim),
        confidence=confidence,
    )


def _check_consistency(flights: Sequence[FlightEvidence]) -> None:
    if not flights:
        raise InconsistentLogsError("expected flight logs, got none")
    first = flights[0]
    seen: dict[str, str] = {}
    for flight in flights:
        if flight.sha256 in seen:
            raise InconsistentLogsError(
                f"expected different flights, {flight.name} is the same flight as {seen[flight.sha256]}"
            )
        seen[flight.sha256] = flight.name
        compared = (
            *("vehicle", "model_hash", "wind", "air", "vehicles", "sensors"),
            *("release", "arithmetic"),
        )
        for field in compared:
            expected, got = getattr(first.header, field), getattr(flight.header, field)
            if got != expected:
                raise InconsistentLogsError(
                    f"{flight.name}: expected {field} {expected} as in {first.name}, got {got}"
                )
        for field, label in (("found_by", "maneuvers by"), ("judged", "deviations of the motion")):
            expected, got = getattr(first, field), getattr(flight, field)
            if got != expected:
                raise InconsistentLogsError(
                    f"{flight.name}: expected {label} {expected} as in {first.name}, got {got}"
                )
        if library_text(flight.library) != library_text(first.library):
            raise InconsistentLogsError(
                f"{flight.name}: expected the library of {first.name}, {first.library.name}, got another "
                f"({flight.library.name})"
            )


def _check_automaton(library: Library) -> None:
    """Refuses trims and maneuvers that no plan can use."""
    if len(library.trims) < 2 or not library.maneuvers:
        raise NoAutomatonError(
            f"expected at least two trims and a maneuver to identify, got {len(library.trims)} and "
            f"{len(library.maneuvers)} in library {library.name!r}"
        )


def _coasting_range(flights: Sequence[FlightEvidence]) -> tuple[float, float]:
    durations = [coast.duration for flight in flights for coast in flight.segments.coasts]
    return min(durations), max(durations)


def _speed_range(library: Library) -> tuple[float, float]:
    speeds = [trim.velocity.forward for trim in library.trims]
    return min(speeds), max(speeds)


def _provenance(
    bounding: Sequence[FlightEvidence],
    centring: Sequence[FlightEvidence],
    confidence: float,
    campaign: Mapping[str, Any] | None,
) -> dict[str, Any]:
    first = bounding[0]
    header, flown = first.header, first.library
    everyone = _sort_flights([*bounding, *centring])
    ordered = flown.conditions.coasting_range
    return {
        "method": (
            f"largest deviations of the {first.judged} motion over flights, maneuvers by {first.found_by}"
        ),
        "deviations_of": first.judged,
        "confidence": confidence,
        "model_hash": header.model_hash,
        "code_version": header.release,
        "backend": header.arithmetic,
        **({} if campaign is None else {"campaign": dict(campaign)}),
        **({} if ordered is None else {"coasting_times_ordered": list(ordered)}),
        "nominal": [flight.header.seed for flight in centring],
        "lost": [flight.header.seed for flight in everyone if flight.lost],
        "unsettled": _unsettled_seeds(everyone),
        "logs_by_seed": {str(flight.header.seed): flight.sha256 for flight in everyone},
    }


def _unsettled_seeds(flights: Sequence[FlightEvidence]) -> dict[str, list[int]]:
    """Returns the seeds of flights with unsettled maneuvers, by maneuver id."""
    listed: dict[str, list[int]] = {}
    for flight in flights:
        for segment in flight.segments.maneuvers:
            if not segment.settled:
                listed.setdefault(str(segment.id), []).append(flight.header.seed)
    return dict(sorted(listed.items(), key=lambda item: int(item[0])))
