"""A grown library: primitives that were never flown, interpolated between those that were.

Around a baseline of second-order responses, what maneuvers do and how far they scatter varies smoothly with
the trims that they join; a spline with leave-one-out errors finds both. The errors of a grown primitive are
the interpolated largest deviations and the interpolation's own error, together, times a factor that is
calibrated on the flown primitives: each is left out in turn, and the factor is the one at which 95 % of them
would have had every flown sample inside the bounds that their neighbours alone give.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.spatial import Delaunay

from flight.errors import FlightError
from flight.library import Library
from flight.library_file import library_hash
from flight.maneuver import Maneuver, ManeuverError
from flight.maneuver_end import Band, ManeuverEnd
from flight.se2 import SE2, Twist
from flight.sign_convention import signed_maneuver_error, signed_trim_error
from flight.statistics import Statistics
from flight.trim import Trim

from .spline import Spline
from .step_baseline import Edge, fitted_baseline

# Differences in m/s and rad/s that count as alike far.
SPEED_SCALE, YAW_RATE_SCALE = 8 * 0.3048, 0.2
# A grown trim is inside the flown ones' hull and no further than this from one, in those scales.
FURTHEST = 0.75
# Share of the flown primitives that the calibrated factor holds.
HELD = 0.95
GROWN = "grown: interpolated, never flown"

_MANEUVER_NUMBERS = ("duration", "forward", "side", "heading_change")
_TRIM_NUMBERS = ("forward", "side", "yaw_rate")
Table = Float[np.ndarray, "n k"]


class CannotGrowError(FlightError):
    """A library has too little evidence to grow from."""


@dataclass(frozen=True, slots=True)
class Fit:
    """How well one number interpolates.

    Attributes:
        number: its name, of a trim's deviations or of a maneuver.
        left_out: root mean square of the leave-one-out errors, in the number's unit; of a trim's deviations,
            of their logarithm.
        smoothing: of the spline.
    """

    number: str
    left_out: float
    smoothing: float


@dataclass(frozen=True)
class Growth:
    """A grown library and what it rests on.

    Attributes:
        library: flown primitives as they were, grown ones without statistics.
        trims: how many of its trims are grown.
        maneuvers: how many of its maneuvers are grown.
        trim_factor: by which the interpolated deviations of trims are inflated.
        maneuver_factor: by which those of maneuvers are.
        fits: how well each number interpolates.
    """

    library: Library
    trims: int
    maneuvers: int
    trim_factor: float
    maneuver_factor: float
    fits: tuple[Fit, ...]


def grow(library: Library, *, speed_step: float, yaw_rate_step: float, name: str) -> Growth:
    """Returns a library with trims on a grid inside the flown range, and maneuvers between neighbours.

    Args:
        library: flown, with statistics and a maneuver-end rule; every side velocity 0.
        speed_step: of the grid, m/s.
        yaw_rate_step: of the grid, rad/s.
        name: of the grown library.

    Raises:
        CannotGrowError: the library lacks statistics or a rule, or is too small.
    """
    rule = library.conditions.maneuver_end
    flown_trims = [trim for trim in library.trims if trim.statistics and not trim.velocity.side]
    ids = {trim.id for trim in flown_trims}
    flown = [row for row in library.maneuvers if row.statistics and {row.from_trim, row.to_trim} <= ids]
    if rule is None or len(flown_trims) < 8 or len(flown) < 16:
        raise CannotGrowError(
            f"expected a maneuver-end rule and statistics of at least 8 trims and 16 maneuvers without side "
            f"velocity, got {len(flown_trims)} trims, {len(flown)} maneuvers"
        )
    places = np.array([_place(trim.velocity) for trim in flown_trims])
    trims, bands, trim_fits, trim_factor = _grown_trims(
        flown_trims, places, rule, speed_step=speed_step, yaw_rate_step=yaw_rate_step
    )
    everything = Library(
        name=name,
        description=library.description,
        vehicle=library.vehicle,
        trims=(*library.trims, *trims),
        maneuvers=library.maneuvers,
        conditions=replace(library.conditions, maneuver_end=replace(rule, bands={**rule.bands, **bands})),
    )
    maneuvers, fits, factor = _grown_maneuvers(everything, flown)
    grown = replace(
        everything,
        description=(
            f"Grown from {library.name}: {len(trims)} trims and {len(maneuvers)} maneuvers that were never "
            "flown are interpolated between those that were."
        ),
        maneuvers=(*library.maneuvers, *maneuvers),
        provenance=_provenance(library, trim_fits + fits, trim_factor, factor),
    )
    return Growth(grown, len(trims), len(maneuvers), trim_factor, factor, tuple(trim_fits + fits))


def _place(velocity: Twist) -> tuple[float, float]:
    return velocity.forward / SPEED_SCALE, velocity.yaw_rate / YAW_RATE_SCALE


def _grown_trims(
    flown: Sequence[Trim], places: Table, rule: ManeuverEnd, *, speed_step: float, yaw_rate_step: float
) -> tuple[list[Trim], dict[int, Band], list[Fit], float]:
    grid = _grid(flown, places, speed_step, yaw_rate_step)
    at = np.array([_place(velocity) for velocity in grid]).reshape(-1, 2)
    largest = np.array([[_largest(trim.statistics, one) for one in _TRIM_NUMBERS] for trim in flown])
    splines = [Spline.fit(places, np.log(column)) for column in largest.T]
    # Left out, the prediction of a logarithm is off by so much: the ratio of what was flown to it.
    factor = _held(np.exp(np.max([one.left_out for one in splines], axis=0)))
    sizes = factor * np.exp(np.column_stack([one.at(at) for one in splines]))
    # A smooth rule of bands through those that were fixed before the flights.
    known = [rule.bands[trim.id] for trim in flown]
    widths = np.column_stack(
        [
            Spline.fit(places, np.array(column)).at(at)
            for column in zip(*((one.forward, one.side, one.yaw_rate) for one in known), strict=True)
        ]
    )
    first = max(trim.id for trim in flown) + 1
    trims, bands = [], {}
    for number, (velocity, size, width) in enumerate(
        zip(grid, sizes.tolist(), widths.tolist(), strict=True), start=first
    ):
        error = signed_trim_error(Twist(*size), velocity)
        trims.append(Trim(number, f"{GROWN.split(':', maxsplit=1)[0]}: {_words(velocity)}", velocity, error))
        bands[number] = Band(*(round(max(one, 1e-3), 4) for one in width))
    fits = [
        Fit(f"trim {name}", _root_mean_square(one.left_out), one.smoothing)
        for name, one in zip(_TRIM_NUMBERS, splines, strict=True)
    ]
    return trims, bands, fits, factor


def _grid(flown: Sequence[Trim], places: Table, speed_step: float, yaw_rate_step: float) -> list[Twist]:
    """Returns the grid's velocities that are inside the flown range, near a flown trim, and not flown."""
    speeds = [trim.velocity.forward for trim in flown]
    rates = [trim.velocity.yaw_rate for trim in flown]
    hull = Delaunay(places)
    found = []
    for i in range(ceil(min(speeds) / speed_step - 1e-9), int(max(speeds) / speed_step + 1e-9) + 1):
        for j in range(ceil(min(rates) / yaw_rate_step - 1e-9), int(max(rates) / yaw_rate_step + 1e-9) + 1):
            velocity = Twist(round(i * speed_step, 6), 0.0, round(j * yaw_rate_step, 6))
            place = np.array(_place(velocity))
            distance = np.linalg.norm(places - place, axis=1).min()
            if 1e-6 < distance <= FURTHEST and hull.find_simplex(place, tol=1e-9) >= 0:
                found.append(velocity)
    return found


def _grown_maneuvers(library: Library, flown: Sequence[Maneuver]) -> tuple[list[Maneuver], list[Fit], float]:
    known = {(row.from_trim, row.to_trim) for row in library.maneuvers}
    reach = max(_step(library, row.from_trim, row.to_trim) for row in flown)
    usable = [trim.id for trim in library.trims if not trim.velocity.side]
    wanted = [
        (left, reached)
        for left in usable
        for reached in usable
        if left != reached and (left, reached) not in known and _step(library, left, reached) <= reach + 1e-6
    ]
    edges = [(row.from_trim, row.to_trim) for row in flown]
    at, points = _features(library, wanted), _features(library, edges)
    nominal = np.array(
        [(row.duration, row.displacement.x, row.displacement.y, row.displacement.heading) for row in flown]
    )
    largest = np.array([[_largest(row.statistics, one) for one in _MANEUVER_NUMBERS] for row in flown])
    baseline = fitted_baseline(library, [_edge(library, edge) for edge in edges], nominal)
    rest = nominal - baseline.maneuvers([_edge(library, edge) for edge in edges])
    values = [Spline.fit(points, column) for column in rest.T]
    sizes = [Spline.fit(points, np.log(np.maximum(column, 1e-4))) for column in largest.T]
    own = np.array([_root_mean_square(one.left_out) for one in values])
    off = np.abs(np.column_stack([one.left_out for one in values]))
    predicted = np.column_stack(
        [column / np.exp(one.left_out) for column, one in zip(largest.T, sizes, strict=True)]
    )
    factor = _held(((off + largest) / (predicted + own)).max(axis=1))
    means = baseline.maneuvers([_edge(library, edge) for edge in wanted]) + np.column_stack(
        [one.at(at) for one in values]
    )
    errors = factor * (np.exp(np.column_stack([one.at(at) for one in sizes])) + own)
    first = max(row.id for row in library.maneuvers) + 1
    maneuvers = [
        _maneuver(library, number, edge, mean, error)
        for number, (edge, mean, error) in enumerate(
            zip(wanted, means.tolist(), errors.tolist(), strict=True), start=first
        )
    ]
    fits = [
        Fit(f"maneuver {name}", _root_mean_square(one.left_out), one.smoothing)
        for name, one in zip(_MANEUVER_NUMBERS, values, strict=True)
    ]
    return maneuvers, fits, factor


def _maneuver(
    library: Library, number: int, edge: tuple[int, int], mean: list[float], error: list[float]
) -> Maneuver:
    duration, forward, side, heading_change = mean
    left, reached = library.trim(edge[0]).velocity, library.trim(edge[1]).velocity
    # At gamma = 1 a duration must stay a time.
    size = ManeuverError(min(error[0], 0.95 * duration), *error[1:])
    return Maneuver(
        number,
        *edge,
        duration,
        SE2(forward, side, heading_change),
        signed_maneuver_error(size, left=left, reached=reached),
        notes=GROWN,
    )


def _edge(library: Library, edge: tuple[int, int]) -> Edge:
    rule = library.conditions.maneuver_end
    assert rule is not None
    return Edge(library.trim(edge[0]).velocity, library.trim(edge[1]).velocity, rule.bands[edge[1]])


def _features(library: Library, edges: Sequence[tuple[int, int]]) -> Table:
    """Returns scaled velocities left and reached."""
    rows = [(*_place(library.trim(a).velocity), *_place(library.trim(b).velocity)) for a, b in edges]
    return np.array(rows).reshape(-1, 4)


def _step(library: Library, left: int, reached: int) -> float:
    """Returns how large a step is: its parts in their scales, summed."""
    one, two = _place(library.trim(left).velocity), _place(library.trim(reached).velocity)
    return abs(one[0] - two[0]) + abs(one[1] - two[1])


def _largest(statistics: Statistics | None, name: str) -> float:
    assert statistics is not None
    return next(one.largest_deviation for one in statistics.scalars if one.name == name)


def _held(ratios: Float[np.ndarray, "n"]) -> float:
    """Returns the factor that holds 95 % of the primitives left out, never below 1 (split conformal)."""
    rank = min(ceil(HELD * (len(ratios) + 1)), len(ratios))
    return max(1.0, float(np.sort(ratios)[rank - 1]))


def _root_mean_square(values: Float[np.ndarray, "n"]) -> float:
    return float(np.sqrt((values**2).mean()))


def _words(velocity: Twist) -> str:
    turn = f", {velocity.yaw_rate:+g} rad/s" if velocity.yaw_rate else ""
    return f"{velocity.forward:.3g} m/s{turn}"


def _provenance(
    library: Library, fits: Sequence[Fit], trim_factor: float, maneuver_factor: float
) -> dict[str, Any]:
    return {
        "method": "splines around second-order responses, errors calibrated by leaving each primitive out",
        "grown_from": {"name": library.name, "sha256": library_hash(library)},
        "share_of_primitives_held": HELD,
        "factors": {"trims": trim_factor, "maneuvers": maneuver_factor},
        "left_out": {one.number: one.left_out for one in fits},
    }
