"""Checks of the response: settling times and the thesis's Table 10."""

from collections.abc import Iterator, Sequence
from math import inf

import numpy as np

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.se2 import SE2, Twist
from flight.units import FOOT
from flightlog.topics import TRUTH
from sim.loop.specification import FlightSpecification
from sim.simulated_helicopter import SimulatedHelicopter
from sim.vehicle.parameters import Parameters

from .check_result import CheckResult
from .velocity_response import simulate_response

SPEED_SETTLING, TURN_SETTLING = 4.2, 3.2
"""Settling times to 5 % in seconds by Table 10: changes of speed, alone or in a turn, and turns."""
DISPLACEMENT_LIMIT, HEADING_LIMIT, DURATION_LIMIT = 0.08, 0.15, 0.15
# Heading changes of Table 10 below this are residuals, rad.
_NO_TURN = 0.05
# Largest printed residual of a maneuver between straight trims, rad.
_STRAIGHT_REMAINDER = 0.03
_STEP = 0.01
_STRAIGHT = tuple((a, 0.0, b, 0.0) for a, b in ((0, 3), (3, 0), (3, 10), (10, 3), (0, 10), (10, 0)))
_COMBINED = ((3, 0.0, 10, 0.6), (10, -0.6, 3, 0.0), (3, 0.1, 10, 0.6), (10, -0.6, 3, -0.1))
_TURNS = (
    *((10, a, 10, b) for a, b in ((0.0, 0.6), (0.6, 0.0), (0.6, -0.6))),
    *((3, a, 3, 0.1) for a in (0.0, -0.1)),
)


def check_response(parameters: Parameters) -> Iterator[CheckResult]:
    """Yields settling times in still air with ideal sensors (thesis, 2.6.2)."""
    for start, turn, end, next_turn in (*_STRAIGHT, *_COMBINED, *_TURNS):
        before, after = Twist(start * FOOT, 0.0, turn), Twist(end * FOOT, 0.0, next_turn)
        flown = simulate_response([(before, _STEP), (after, 12.0)], vehicle=parameters)
        settling = SPEED_SETTLING if start != end else TURN_SETTLING
        name = f"{start} ft/s, {turn:g} rad/s to {end} ft/s, {next_turn:g} rad/s"
        for field, what in (("forward", "speed"), ("yaw_rate", "yaw rate")):
            first, last = getattr(before, field), getattr(after, field)
            if first != last:
                time = settling_time(flown.column(field), start=first, end=last)
                yield CheckResult(
                    "response", f"{name}: {what} settles", time, "s", 0.9 * settling, 1.1 * settling
                )


def settling_time(values: Sequence[float] | np.ndarray, *, start: float, end: float) -> float:
    """Returns the 5 % settling time of a response, s.

    Args:
        values: samples every 10 ms.
        start: value before the change.
        end: value after the change.
    """
    outside = np.nonzero(np.abs(np.asarray(values) - end) > 0.05 * abs(end - start))[0]
    return float(outside.max(initial=-1) + 1) * _STEP


def check_table_10(printed: Library, parameters: Parameters | None = None) -> Iterator[CheckResult]:
    """Yields every maneuver beside the thesis's Table 10.

    Flown in still air with ideal sensors.

    Args:
        printed: the table, with the maneuver-end rule of still air in its conditions.
        parameters: vehicle; `models/gtmax.toml` if None.
    """
    for maneuver in printed.maneuvers:
        duration, displacement, swept = _perform(maneuver, printed, parameters)
        straight = all(
            printed.trim(trim).velocity.yaw_rate == 0.0 for trim in (maneuver.from_trim, maneuver.to_trim)
        )
        name = f"Table 10, {maneuver.from_trim} to {maneuver.to_trim}"
        yield _ratio_result(
            f"{name}: duration", duration, maneuver.duration, DURATION_LIMIT if straight else inf, unit="s"
        )
        if straight:
            forward = maneuver.displacement.x
            yield _ratio_result(
                f"{name}: displacement", displacement.x, forward, DISPLACEMENT_LIMIT, unit="m"
            )
        if abs(maneuver.displacement.heading) >= _NO_TURN:
            limit = inf if maneuver.notes.startswith("suspect") else HEADING_LIMIT
            changes = displacement.heading, maneuver.displacement.heading
            yield _ratio_result(f"{name}: heading change", *changes, limit, unit="rad")
        else:
            high = _STRAIGHT_REMAINDER if straight else HEADING_LIMIT * swept
            beside = f"printed {maneuver.displacement.heading:g} rad, swept {swept:.3f} rad"
            residual = abs(displacement.heading)
            yield CheckResult(
                "response", f"{name}: residual heading", residual, "rad", high=high, beside=beside
            )


def _perform(maneuver: Maneuver, library: Library, parameters: Parameters | None) -> tuple[float, SE2, float]:
    """Flies one maneuver from its settled trim.

    Returns:
        Duration in s, displacement, and total angle swept in rad.
    """
    specification = FlightSpecification(seed=1, start_trim=maneuver.from_trim, ideal_navigation=True)
    helicopter = SimulatedHelicopter(specification, library, parameters=parameters)
    entry = helicopter.truth.pose
    leg = helicopter.perform(maneuver)
    swept = float(np.abs(np.diff(helicopter.log()[TRUTH]["heading"])).sum())
    return leg.duration, entry.inverse() @ helicopter.truth.pose, swept


def _ratio_result(name: str, flown: float, printed: float, limit: float, *, unit: str) -> CheckResult:
    low, high = (None, None) if limit == inf else (1.0 - limit, 1.0 + limit)
    beside = f"flown {flown:.3f} {unit}, printed {printed:.3f} {unit}"
    return CheckResult("response", f"{name}, ratio", flown / printed, "-", low, high, beside)
