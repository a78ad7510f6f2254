"""Interpolated library: unflown primitives between flown ones.

Relative to a baseline of second-order responses, the values and the scatter of maneuvers vary smoothly with
the trims that they join; splines with leave-one-out errors interpolate both. The errors of an interpolated
primitive are the interpolated largest deviations plus the interpolation's own error, times a factor that is
calibrated by cross-validation on the flown primitives (`interpolation_claim`).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.automaton.maneuver import Maneuver
from flight.automaton.sign_convention import signed_trim_error
from flight.automaton.statistics import InterpolationClaim
from flight.automaton.trim import Trim
from flight.errors import FlightError
from flight.se2 import Twist

from .cross_validation import InterpolationFit
from .interpolated_maneuvers import baseline_of_flights, interpolate_maneuvers, velocity_step_of
from .interpolated_trims import interpolate_trims
from .step_baseline import Baseline
from .trim_scatter import TrimScatter, trim_scatter

LEAST_TRIMS, LEAST_MANEUVERS = 8, 16
"""Least numbers of flown primitives for the calibration."""


class CannotInterpolateError(FlightError):
    """The library has too few flown primitives to interpolate."""


@dataclass(frozen=True)
class InterpolatedLibrary:
    """An interpolated library with its claims and cross-validation.

    Attributes:
        library: flown maneuvers unchanged, interpolated ones without statistics; all trims that interpolated
            maneuvers enter have the claim of interpolated trims.
        trims: number of interpolated trims.
        maneuvers: number of interpolated maneuvers.
        trim_claim: coverage claim of the trims that interpolated maneuvers enter.
        maneuver_claim: coverage claim of interpolated maneuvers.
        fits: cross-validation of each number.
    """

    library: Library
    trims: int
    maneuvers: int
    trim_claim: InterpolationClaim
    maneuver_claim: InterpolationClaim
    fits: tuple[InterpolationFit, ...]


def interpolate_library(
    library: Library,
    *,
    speed_step: float,
    yaw_rate_step: float,
    name: str,
    coverage: float = 0.95,
    confidence: float = 0.95,
) -> InterpolatedLibrary:
    """Interpolates trims on a grid and maneuvers between neighbours.

    A coast's largest deviation is often the residual of the maneuver before it. A flown trim that an
    interpolated maneuver enters therefore gets new bounds, never smaller than the flown ones, and the claim
    of the interpolated trims.

    Args:
        library: flown library with statistics and a maneuver-end rule; trims with side velocity are ignored.
        speed_step: grid step, m/s.
        yaw_rate_step: grid step, rad/s.
        name: name of the interpolated library.
        coverage: share of interpolated primitives whose bounds hold as many flights as were flown.
        confidence: confidence of that share.

    Raises:
        CannotInterpolateError: the library lacks statistics or a rule, is too small, or is interpolated
            itself.
    """
    rule = library.conditions.maneuver_end
    flown_trims = [trim for trim in library.trims if trim.statistics and not trim.velocity.side]
    ids = {trim.id for trim in flown_trims}
    flown = [row for row in library.maneuvers if row.statistics and {row.from_trim, row.to_trim} <= ids]
    if rule is None or len(flown_trims) < LEAST_TRIMS or len(flown) < LEAST_MANEUVERS:
        raise CannotInterpolateError(
            f"expected a maneuver-end rule and statistics of at least {LEAST_TRIMS} trims and "
            f"{LEAST_MANEUVERS} maneuvers without side velocity, got {len(flown_trims)} trims, "
            f"{len(flown)} maneuvers"
        )
    if library.interpolated:
        raise CannotInterpolateError(
            f"expected a flown library, got {library.name}, which has interpolated primitives"
        )
    new, bands = interpolate_trims(flown_trims, rule, speed_step=speed_step, yaw_rate_step=yaw_rate_step)
    everything = replace(
        library,
        name=name,
        trims=(*library.trims, *new),
        conditions=replace(library.conditions, maneuver_end=replace(rule, bands={**rule.bands, **bands})),
    )
    baseline = baseline_of_flights(everything, flown)
    wanted = {"coverage": coverage, "confidence": confidence}
    try:
        rows = interpolate_maneuvers(everything, flown, baseline, **wanted)
    except ValueError as error:
        raise CannotInterpolateError(
            f"{library.name}: too few maneuvers for cross-validation by trims: {error}"
        ) from None
    joined = replace(everything, maneuvers=(*library.maneuvers, *rows.maneuvers))
    entered = {row.to_trim for row in rows.maneuvers}
    held = [trim for trim in joined.trims if trim.id in entered]
    scatter = trim_scatter(
        flown_trims,
        held,
        tails_flown=_entry_residuals(joined, flown_trims, flown, baseline),
        tails_wanted=_entry_residuals(joined, held, joined.maneuvers, baseline),
        **wanted,
    )
    interpolated = replace(
        joined,
        description=(
            f"Grown from {library.name}: {len(new)} trims and {len(rows.maneuvers)} maneuvers that were "
            "never flown are interpolated between those that were."
        ),
        trims=tuple(_with_scatter(trim, scatter) for trim in joined.trims),
        provenance=_provenance(library, scatter.fits + rows.fits),
    )
    return InterpolatedLibrary(
        interpolated, len(new), len(rows.maneuvers), scatter.claim, rows.claim, scatter.fits + rows.fits
    )


def _entry_residuals(
    library: Library, trims: Sequence[Trim], maneuvers: Iterable[Maneuver], baseline: Baseline
) -> Float[np.ndarray, "n 3"]:
    """Returns each trim's largest residual over its incoming maneuvers."""
    found = {trim.id: np.zeros(3) for trim in trims}
    for row in maneuvers:
        if row.to_trim in found:
            forward, yaw_rate = baseline.residual(velocity_step_of(library, (row.from_trim, row.to_trim)))
            found[row.to_trim] = np.maximum(found[row.to_trim], (forward, 0.0, yaw_rate))
    return np.array(list(found.values())).reshape(-1, 3)


def _with_scatter(trim: Trim, scatter: TrimScatter) -> Trim:
    if trim.id not in scatter.sizes:
        return trim
    size = Twist(*scatter.sizes[trim.id].tolist())
    error = signed_trim_error(size, trim.velocity)
    # A law of the flown entries does not hold for those by interpolated maneuvers.
    return replace(trim, error=error, interpolated=scatter.claim, law=None)


def _provenance(library: Library, fits: Sequence[InterpolationFit]) -> dict[str, Any]:
    ordered = library.provenance.get("coasting_times_ordered")
    return {
        "method": "splines around second-order responses, errors calibrated by leaving flown primitives out",
        "grown_from": {"name": library.name, "sha256": library_hash(library)},
        "deviations_of": library.provenance.get("deviations_of", "true"),
        **({} if ordered is None else {"coasting_times_ordered": ordered}),
        "left_out": {one.number: one.cross_validation_error for one in fits},
    }
