"""Check that the library's maneuvers reach no attitude or servo-rate limit."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from flight.automaton.library import Library
from flight.errors import FlightLostError
from flightlog.log import FlightLog
from flightlog.topics import CONTROLS, TRUTH
from sim.campaign_flight import fly_sequence
from sim.control.gains import Gains
from sim.loop.backend import Backend
from sim.loop.motion import Controls
from sim.loop.specification import CONTROL_RATE, FlightSpecification
from sim.simulated_helicopter import SimulatedHelicopter
from sim.vehicle.parameters import Parameters

from .check_result import CheckResult

# Factor that removes a limit in effect.
_WITHOUT_LIMITS = 1000.0


def check_limits(
    flights: Sequence[FlightSpecification],
    library: Library,
    parameters: Parameters,
    *,
    gains: Gains | None = None,
) -> Iterator[CheckResult]:
    """Yields the use of the limits, and the effect of removing them.

    Removing a limit that is never reached changes no bit of a flight.

    Args:
        flights: specified sequences.
        library: library flown with.
        parameters: vehicle.
        gains: gains of the controller.
    """
    gains = gains or Gains()
    servos = parameters.servos
    free_servos = replace(
        servos, rate=_WITHOUT_LIMITS * servos.rate, pedal_rate=_WITHOUT_LIMITS * servos.pedal_rate
    )
    free = (
        replace(parameters, servos=free_servos),
        replace(gains, tilt_limit=_WITHOUT_LIMITS * gains.tilt_limit),
    )
    logs = [_fly(flight, library, parameters, gains) for flight in flights]
    lifted = [_fly(flight, library, *free) for flight in flights]
    maneuvers = sum(len(flight.trims) - 1 for flight in flights)
    beside = f"{maneuvers} maneuvers, {len(flights)} flights in wind class {flights[0].wind}"
    off = max(_largest_distance(one, other) for one, other in zip(logs, lifted, strict=True))
    yield CheckResult(
        "limits", "change of motion without tilt and servo-rate limits", off, "m", None, 0.0, beside
    )
    lost = sum(log.header.outcome != "completed" for log in logs)
    yield CheckResult("limits", "flights lost", float(lost), "-", None, 0.0, beside)
    tilt = max(float(np.abs(log[TRUTH][name]).max()) for log in logs for name in ("roll", "pitch"))
    yield CheckResult("limits", "largest roll or pitch", tilt, "rad", beside=beside)
    for name in Controls._fields:
        limit = servos.pedal_rate if name == "pedal" else servos.rate
        rates = (float(np.abs(np.diff(log[CONTROLS][name])).max()) * CONTROL_RATE for log in logs)
        ratio = max(rates) / limit
        yield CheckResult("limits", f"largest {name} servo rate / limit", ratio, "-", None, 0.99, beside)


def _fly(flight: FlightSpecification, library: Library, parameters: Parameters, gains: Gains) -> FlightLog:
    helicopter = SimulatedHelicopter(
        flight, library, parameters=parameters, gains=gains, backend=Backend.INTERPRETED
    )
    try:
        fly_sequence(helicopter, flight.sequence, library=library)
    except FlightLostError:
        # The outcome is in the log's header.
        return helicopter.log()
    return helicopter.log()


def _largest_distance(log: FlightLog, other: FlightLog) -> float:
    """Returns the largest distance between two flights in m."""
    if len(log[TRUTH]) != len(other[TRUTH]):
        return np.inf
    differences = (log[TRUTH][name] - other[TRUTH][name] for name in ("north", "east", "down"))
    return max(float(np.abs(difference).max()) for difference in differences)
