"""Interpolated trims: grid of velocities and bands."""

from collections.abc import Sequence
from math import ceil

import numpy as np
from jaxtyping import Float
from scipy.spatial import Delaunay

from flight.automaton.maneuver_end import Band, ManeuverEnd
from flight.automaton.trim import Trim
from flight.se2 import Twist

from .cross_validation import scaled_velocity
from .spline import Spline

# Largest distance of an interpolated trim from a flown one, in units of `scaled_velocity`; it is also inside
# the convex hull of the flown ones.
FURTHEST = 0.75

Velocities = Float[np.ndarray, "_ 2"]


def interpolate_trims(
    flown: Sequence[Trim], rule: ManeuverEnd, *, speed_step: float, yaw_rate_step: float
) -> tuple[tuple[Trim, ...], dict[int, Band]]:
    """Returns trims without errors on a grid, and their bands.

    Args:
        flown: flown trims.
        rule: rule with the bands of flown trims, which are interpolated.
        speed_step: grid step, m/s.
        yaw_rate_step: grid step, rad/s.
    """
    places = np.array([scaled_velocity(trim.velocity) for trim in flown])
    grid = _grid(flown, places, speed_step, yaw_rate_step)
    at = np.array([scaled_velocity(velocity) for velocity in grid]).reshape(-1, 2)
    first = max(trim.id for trim in flown) + 1
    trims = tuple(
        Trim(number, f"grown: {_describe(velocity)}", velocity, Twist(0.0, 0.0, 0.0))
        for number, velocity in enumerate(grid, start=first)
    )
    return trims, _bands(flown, places, rule, at, first)


def _bands(
    flown: Sequence[Trim], places: Velocities, rule: ManeuverEnd, at: Velocities, first: int
) -> dict[int, Band]:
    """Interpolates the bands that were fixed before the flights."""
    known = [rule.bands[trim.id] for trim in flown]
    columns = zip(*((one.forward, one.side, one.yaw_rate) for one in known), strict=True)
    widths = np.column_stack([Spline.fit(places, np.array(column)).at(at) for column in columns])
    return {
        number: Band(*(round(max(one, 1e-3), 4) for one in width))
        for number, width in enumerate(widths.tolist(), start=first)
    }


def _grid(flown: Sequence[Trim], places: Velocities, speed_step: float, yaw_rate_step: float) -> list[Twist]:
    """Returns unflown grid velocities inside the range, near flown trims."""
    speeds = [trim.velocity.forward for trim in flown]
    rates = [trim.velocity.yaw_rate for trim in flown]
    hull = Delaunay(places)
    found = []
    for i in range(ceil(min(speeds) / speed_step - 1e-9), int(max(speeds) / speed_step + 1e-9) + 1):
        for j in range(ceil(min(rates) / yaw_rate_step - 1e-9), int(max(rates) / yaw_rate_step + 1e-9) + 1):
            velocity = Twist(round(i * speed_step, 6), 0.0, round(j * yaw_rate_step, 6))
            here = np.array(scaled_velocity(velocity))
            distance = np.linalg.norm(places - here, axis=1).min()
            if 1e-6 < distance <= FURTHEST and hull.find_simplex(here, tol=1e-9) >= 0:
                found.append(velocity)
    return found


def _describe(velocity: Twist) -> str:
    turn = f", {velocity.yaw_rate:+g} rad/s" if velocity.yaw_rate else ""
    return f"{velocity.forward:.3g} m/s{turn}"
