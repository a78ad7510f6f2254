"""Interpolated maneuvers between trims, with errors and claim."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.sign_convention import signed_maneuver_error
from flight.automaton.statistics import InterpolationClaim
from flight.se2 import SE2
from identification.design.schedule import Edge
from identification.statistics.samples import MANEUVER_SCALARS

from .cross_validation import (
    InterpolationFit,
    largest_deviation,
    least_flights,
    root_mean_square,
    scaled_velocity,
)
from .interpolation_claim import calibrate_claim
from .spline import Spline
from .step_baseline import Baseline, VelocityStep, fit_baseline

INTERPOLATED_NOTE = "grown: interpolated, never flown"

# Floor for deviations in s, m and rad before the logarithm is taken.
_NONE = 1e-4

Table = Float[np.ndarray, "n k"]


@dataclass(frozen=True)
class InterpolatedManeuvers:
    """Interpolated maneuvers with their claim and cross-validation."""

    maneuvers: tuple[Maneuver, ...]
    claim: InterpolationClaim
    fits: tuple[InterpolationFit, ...]


def baseline_of_flights(library: Library, flown: Sequence[Maneuver]) -> Baseline:
    """Fits the second-order responses to flown maneuvers."""
    steps = [velocity_step_of(library, (row.from_trim, row.to_trim)) for row in flown]
    return fit_baseline(library, steps, _scalar_rows(flown))


def velocity_step_of(library: Library, edge: Edge) -> VelocityStep:
    """Returns the velocity step of an edge, with the target's band."""
    rule = library.conditions.maneuver_end
    assert rule is not None
    return VelocityStep(library.trim(edge[0]).velocity, library.trim(edge[1]).velocity, rule.bands[edge[1]])


def interpolate_maneuvers(
    library: Library, flown: Sequence[Maneuver], baseline: Baseline, *, coverage: float, confidence: float
) -> InterpolatedManeuvers:
    """Interpolates the missing maneuvers between trims within the flown range.

    Maneuvers with a duration error not below the duration are left out.

    Args:
        library: trims, interpolated ones included, and the rule with all bands.
        flown: maneuvers with statistics.
        baseline: baseline of the interpolation.
        coverage: share of interpolated maneuvers whose bounds hold.
        confidence: confidence of that share.
    """
    edges, wanted = [(row.from_trim, row.to_trim) for row in flown], _missing_edges(library, flown)
    points, at = _points(library, edges), _points(library, wanted)
    deviations = np.array(
        [[largest_deviation(row.statistics, one) for one in MANEUVER_SCALARS] for row in flown]
    )
    groups = _edges_sharing_a_trim(edges)
    rest = _scalar_rows(flown) - baseline.maneuvers([velocity_step_of(library, edge) for edge in edges])
    values = [Spline.fit(points, column, groups=groups) for column in rest.T]
    sizes = [Spline.fit(points, np.log(np.maximum(column, _NONE)), groups=groups) for column in deviations.T]
    own = np.array([root_mean_square(one.left_out) for one in values])
    off = np.abs(np.column_stack([one.left_out for one in values]))
    predicted = np.maximum(deviations, _NONE) / np.exp(np.column_stack([one.left_out for one in sizes]))
    claim = calibrate_claim(
        ((off + deviations) / (predicted + own)).max(axis=1),
        flights=least_flights(row.statistics for row in flown),
        coverage=coverage,
        confidence=confidence,
    )
    means = baseline.maneuvers([velocity_step_of(library, edge) for edge in wanted]).reshape(-1, 4)
    means = means + np.column_stack([one.at(at) for one in values])
    # A maneuver lasts at least the dwell.
    means[:, 0] = np.maximum(means[:, 0], baseline.dwell)
    errors = claim.factor * (np.exp(np.column_stack([one.at(at) for one in sizes])) + own)
    first = max(row.id for row in library.maneuvers) + 1
    known = [
        row for row in zip(wanted, means.tolist(), errors.tolist(), strict=True) if row[2][0] < row[1][0]
    ]
    return InterpolatedManeuvers(
        tuple(
            _maneuver(library, number, edge, mean=mean, error=error, claim=claim)
            for number, (edge, mean, error) in enumerate(known, start=first)
        ),
        claim,
        tuple(
            InterpolationFit(f"maneuver {name}", root_mean_square(one.left_out), one.smoothing)
            for name, one in zip(MANEUVER_SCALARS, values, strict=True)
        ),
    )


def _missing_edges(library: Library, flown: Sequence[Maneuver]) -> list[Edge]:
    """Returns unjoined pairs of trims no further apart than flown ones."""
    known = {(row.from_trim, row.to_trim) for row in library.maneuvers}
    reach = max(_distance(library, (row.from_trim, row.to_trim)) for row in flown)
    usable = [trim.id for trim in library.trims if not trim.velocity.side]
    return [
        (left, reached)
        for left in usable
        for reached in usable
        if left != reached
        and (left, reached) not in known
        and _distance(library, (left, reached)) <= reach + 1e-6
    ]


def _edges_sharing_a_trim(edges: Sequence[Edge]) -> list[list[int]]:
    """Returns for each edge the indices of edges that share a trim."""
    return [[index for index, other in enumerate(edges) if not set(edge).isdisjoint(other)] for edge in edges]


def _maneuver(
    library: Library,
    number: int,
    edge: Edge,
    *,
    mean: list[float],
    error: list[float],
    claim: InterpolationClaim,
) -> Maneuver:
    duration, *displacement = mean
    return Maneuver(
        number,
        *edge,
        duration,
        SE2(*displacement),
        signed_maneuver_error(
            ManeuverError(*error),
            left=library.trim(edge[0]).velocity,
            reached=library.trim(edge[1]).velocity,
        ),
        notes=INTERPOLATED_NOTE,
        interpolated=claim,
    )


def _scalar_rows(flown: Sequence[Maneuver]) -> Table:
    """Returns a row per maneuver: duration, forward, side, heading change."""
    return np.array(
        [(row.duration, row.displacement.x, row.displacement.y, row.displacement.heading) for row in flown]
    )


def _points(library: Library, edges: Sequence[Edge]) -> Table:
    """Returns the scaled velocities of entry and exit trims."""
    rows = [
        (*scaled_velocity(library.trim(a).velocity), *scaled_velocity(library.trim(b).velocity))
        for a, b in edges
    ]
    return np.array(rows).reshape(-1, 4)


def _distance(library: Library, edge: Edge) -> float:
    """Returns the size of a step: the sum of its scaled parts."""
    one, two = (scaled_velocity(library.trim(trim).velocity) for trim in edge)
    return abs(one[0] - two[0]) + abs(one[1] - two[1])
