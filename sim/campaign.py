"""Many flights on any executor; logs are written whole or not at all, whatever the workers' order."""

from collections.abc import Iterable, Iterator
from concurrent.futures import Executor, as_completed
from dataclasses import dataclass
from pathlib import Path

from flight.errors import AlreadyExistsError, FlightLostError
from flight.library import Library
from flight.log import PRIMITIVE, FlightLog
from flight.log_file import publish_log
from flight.sequence import Sequence
from flight.vehicle import Leg, Vehicle

from .fly import SimulatedHelicopter
from .specification import FlightSpecification


@dataclass(frozen=True, slots=True)
class FlightFlown:
    """What became of one flight of a campaign.

    Attributes:
        specification: what was to be flown.
        path: its log.
        outcome: `completed`, or what went wrong.
        timeouts: maneuvers that ended by time-out.
        duration: simulated time in s.
    """

    specification: FlightSpecification
    path: Path
    outcome: str
    timeouts: int
    duration: float


def fly_sequence(vehicle: Vehicle, sequence: Sequence, *, library: Library) -> tuple[Leg, ...]:
    """Flies a sequence of trims, joined by the library's maneuvers.

    Args:
        vehicle: holds the first trim of the sequence.
        sequence: trims and coasting times.
        library: holds the maneuvers that join them.

    Returns:
        Coasts and maneuvers in turn.

    Raises:
        NoManeuverError: two trims follow one another that no maneuver joins.
        FlightLostError: the flight ended in the ground or diverged.
    """
    maneuvers = library.maneuvers_along(sequence.trims)
    legs = [vehicle.coast(sequence.coasting_times[0])]
    for maneuver, coasting_time in zip(maneuvers, sequence.coasting_times[1:], strict=True):
        legs.append(vehicle.perform(maneuver))
        legs.append(vehicle.coast(coasting_time))
    return tuple(legs)


def fly_specification(specification: FlightSpecification, library: Library) -> FlightLog:
    """Flies the sequence of a specification; a lost flight gives its log up to there."""
    helicopter = SimulatedHelicopter(specification, library)
    try:
        fly_sequence(helicopter, specification.sequence, library=library)
    except FlightLostError:
        # The log says so: its header carries the outcome.
        return helicopter.log()
    return helicopter.log()


def fly_campaign(
    specifications: Iterable[FlightSpecification],
    library: Library,
    *,
    folder: Path,
    executor: Executor,
    force: bool = False,
) -> Iterator[FlightFlown]:
    """Flies every specification and writes its log to `folder/NAME.mcap`.

    Yields:
        Flights as they are done; their logs do not depend on that order.

    Raises:
        AlreadyExistsError: a log exists and `force` is not set.
    """
    flights = [
        executor.submit(_fly_and_publish, specification, library, folder, force)
        for specification in specifications
    ]
    try:
        for flight in as_completed(flights):
            yield flight.result()
    finally:
        for flight in flights:
            flight.cancel()


def _fly_and_publish(
    specification: FlightSpecification, library: Library, folder: Path, force: bool
) -> FlightFlown:
    path = folder / f"{specification.name}.mcap"
    if path.exists() and not force:
        raise AlreadyExistsError(path)
    log = fly_specification(specification, library)
    publish_log(log, path, force=force)
    return FlightFlown(
        specification=specification,
        path=path,
        outcome=log.header.outcome,
        timeouts=int(log[PRIMITIVE]["timed_out"].sum()),
        duration=log.duration,
    )
