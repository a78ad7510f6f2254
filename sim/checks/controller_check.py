"""Checks of the controller: margins, delay and adaptation."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from flight.se2 import Twist
from flight.units import FOOT
from sim.control.controller import Controller
from sim.control.gains import Gains
from sim.vehicle.parameters import Parameters, change_vehicle

from .check_result import CheckResult
from .margins import PATHS, Loop, close_loop, compute_margins, is_stable
from .velocity_response import Response, simulate_response

GAIN_LIMIT, PHASE_LIMIT = 6.0, 45.0
_STEP, _HEIGHT = 0.01, 30.0
# The trims of the thesis's Table 9.
TRIMS = tuple(
    Twist(speed * FOOT, 0.0, rate)
    for speed, rate in ((0, 0), (3, 0), (10, 0), (3, -0.3), (3, 0.3), (10, -0.6), (10, 0.6))
)
# Straight flight above these speeds, up to the end of the speed range.
FAST_FLIGHT = tuple(Twist(speed * FOOT, 0.0, 0.0) for speed in (16, 32, 48, 64, 80))
_MASSES = (0.8, 1.0, 1.2)
_VEHICLE_CHANGES = {
    "nominal": {},
    "mass +20 %": {"mass": 1.2},
    "rotor gain -15 %": {"lift": 0.85},
    "centre of mass 3 cm back": {"hub_forward": 0.03},
    "all three": {"mass": 1.2, "lift": 0.85, "hub_forward": 0.03},
}
_WALK = (0, 1, 2, 6, 2, 5, 1, 0)
_LEG = 10.0
_FAST = TRIMS[2]
# Body rate above which a flight counts as unstable, rad/s.
_UNSTABLE_RATE = 1.0


def check_margins(
    parameters: Parameters, *, gains: Gains | None = None, extra_delay: float = 0.0
) -> Iterator[CheckResult]:
    """Yields each path's smallest margins over trims and masses.

    With the full delay; first at the trims of Table 9, then in straight flight up to 80 ft/s.
    """
    controller = Controller(parameters, height=_HEIGHT, step=_STEP, gains=gains)
    for velocities, where, prefix in (
        (TRIMS, f"{len(TRIMS)} trims", ""),
        (FAST_FLIGHT, "16 to 80 ft/s", "fast, "),
    ):
        loops = [
            close_loop(
                change_vehicle(parameters, mass=mass, extra_delay=extra_delay),
                *(controller, parameters, velocity),
                height=_HEIGHT,
                step=_STEP,
            )
            for mass in _MASSES
            for velocity in velocities
        ]
        yield from _smallest_margins(loops, prefix, beside=f"{where}, mass -20 %, 0, +20 %")


def _smallest_margins(loops: Sequence[Loop], prefix: str, *, beside: str) -> Iterator[CheckResult]:
    """Yields each path's smallest margins and the share of stable loops."""
    found = [compute_margins(loop) for loop in loops]
    for path in PATHS:
        gain = min(margin[path].gain for margin in found)
        phase = min(margin[path].phase for margin in found)
        yield CheckResult("margins", f"{prefix}gain at {path}", gain, "dB", low=GAIN_LIMIT, beside=beside)
        yield CheckResult("margins", f"{prefix}phase at {path}", phase, "deg", low=PHASE_LIMIT, beside=beside)
    stable = sum(is_stable(loop) for loop in loops) / len(loops)
    yield CheckResult("margins", f"{prefix}share of stable loops", stable, "-", low=1.0, beside=beside)


def check_delay(parameters: Parameters) -> Iterator[CheckResult]:
    """Yields the delay margin beyond the model: computed, flown, adaptive."""
    controller = Controller(parameters, height=_HEIGHT, step=_STEP)
    loop = close_loop(parameters, controller, parameters, _FAST, height=_HEIGHT, step=_STEP)
    computed = _largest_passing_delay(lambda periods: is_stable(loop, extra_delay=periods)) * _STEP
    frozen, adapting = (flown_delay_margin(parameters, adaptive=on) for on in (False, True))
    beside = "10 ft/s, all servos at once"
    yield CheckResult("delay", "margin beyond the model, computed", computed, "s", low=0.02, beside=beside)
    yield CheckResult("delay", "margin flown / computed", frozen / computed, "-", 0.9, 1.1, beside)
    yield CheckResult("delay", "margin flown with adaptation", adapting, "s", low=0.02, beside=beside)


def flown_delay_margin(parameters: Parameters, *, adaptive: bool) -> float:
    """Returns the largest extra delay of a stable flight, s."""
    nudged = Twist(_FAST.forward + 0.1, 0.1, 0.02)

    def settles(periods: int) -> bool:
        vehicle = change_vehicle(parameters, extra_delay=periods * _STEP)
        return not _is_unstable(
            simulate_response([(nudged, 1.0), (_FAST, 39.0)], vehicle=vehicle, adaptive=adaptive)
        )

    return _largest_passing_delay(settles) * _STEP


def _largest_passing_delay(holds: Callable[[int], bool]) -> int:
    """Returns the largest passing number of periods below 1 s, by bisection."""
    good, bad = 0, round(1.0 / _STEP)
    while bad - good > 1:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if holds(middle) else (good, middle)
    return good


def _is_unstable(flown: Response) -> bool:
    """Returns True if the flight was lost or its oscillation grows.

    Growth is judged by the last two quarters of the flight.
    """
    if flown.lost:
        return True
    rates = np.abs(np.stack([flown.column(name) for name in ("roll_rate", "pitch_rate", "yaw_rate")]))
    third, last = (part.max() for part in np.array_split(rates, 4, axis=1)[2:])
    return bool(last > _UNSTABLE_RATE or last > max(1.2 * third, 1e-3 + np.abs(flown.reference[-1, 2])))


def check_adaptation(parameters: Parameters, *, gains: Gains | None = None) -> Iterator[CheckResult]:
    """Yields the ratio of velocity errors with and without adaptation."""
    for name, change in _VEHICLE_CHANGES.items():
        vehicle = change_vehicle(parameters, **change)
        high = 1.0 if not change else 0.5
        without, adapting = (
            fly_walk(vehicle, parameters, adaptive=on, gains=gains).velocity_error for on in (False, True)
        )
        beside = f"{without:.3f} m/s without, {adapting:.3f} m/s with; wind class gtmax"
        ratio = adapting / without
        yield CheckResult("adaptation", f"velocity error ratio, {name}", ratio, "-", high=high, beside=beside)


def fly_walk(
    vehicle: Parameters, controller_model: Parameters, *, adaptive: bool, gains: Gains | None = None
) -> Response:
    """Flies every trim in wind class `gtmax`, without the first 10 s."""
    legs = [(TRIMS[0], _LEG), *((TRIMS[place], _LEG) for place in _WALK)]
    return simulate_response(
        legs,
        vehicle=vehicle,
        controller_model=controller_model,
        adaptive=adaptive,
        gains=gains,
        wind="gtmax",
        skip=round(_LEG / _STEP),
    )
