"""A grown library: primitives that were never flown, interpolated between those that were.

Around a baseline of second-order responses, what maneuvers do and how far they scatter varies smoothly with
the trims that they join; a spline with leave-one-out errors finds both. The errors of a grown primitive are
the interpolated largest deviations and the interpolation's own error, together, times a factor that is
calibrated on the flown primitives, each left out in turn (`grown_claim`).
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
"""Flown primitives below which there is nothing to calibrate on."""


class CannotInterpolateError(FlightError):
    """A library has too little evidence to grow from."""


@dataclass(frozen=True)
class InterpolatedLibrary:
    """A grown library and what it rests on.

    Attributes:
        library: flown maneuvers as they were, grown ones without statistics; trims that grown maneuvers lead
            to, flown ones too, with the claim of what is grown.
        trims: how many of its trims are grown.
        maneuvers: how many of its maneuvers are grown.
        trim_claim: what is claimed of the trims that grown maneuvers lead to.
        maneuver_claim: what is claimed of grown maneuvers.
        fits: how well each number interpolates.
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
    """Returns a library with trims on a grid inside the flown range, and maneuvers between neighbours.

    A coast's largest deviation is often what is left of the maneuver before it. So a flown trim that a grown
    maneuver leads to is held after something that no flight saw: it is bounded anew, never closer than it was
    flown, and claims what the grown trims claim.

    Args:
        library: flown, with statistics and a maneuver-end rule; every side velocity 0.
        speed_step: of the grid, m/s.
        yaw_rate_step: of the grid, rad/s.
        name: of the grown library.
        coverage: share of the grown primitives that are to hold as many flights as were flown.
        confidence: of that share.

    Raises:
        CannotGrowError: the library lacks statistics or a rule, or is too small, or is grown itself.
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
        raise CannotInterpolateError(f"{library.name} is grown already: grow the library that was flown")
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
            f"{library.name} has too few maneuvers to leave out those of one trim at a time: {error}"
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
    grown = replace(
        joined,
        description=(
            f"Grown from {library.name}: {len(new)} trims and {len(rows.maneuvers)} maneuvers that were "
            "never flown are interpolated between those that were."
        ),
        trims=tuple(_with_scatter(trim, scatter) for trim in joined.trims),
        provenance=_provenance(library, scatter.fits + rows.fits),
    )
    return InterpolatedLibrary(
        grown, len(new), len(rows.maneuvers), scatter.claim, rows.claim, scatter.fits + rows.fits
    )


def _entry_residuals(
    library: Library, trims: Sequence[Trim], maneuvers: Iterable[Maneuver], baseline: Baseline
) -> Float[np.ndarray, "n 3"]:
    """Returns the most that is left when a coast begins, over all maneuvers that lead to a trim."""
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
    return replace(trim, error=signed_trim_error(size, trim.velocity), interpolated=scatter.claim)


def _provenance(library: Library, fits: Sequence[InterpolationFit]) -> dict[str, Any]:
    ordered = library.provenance.get("coasting_times_ordered")
    return {
        "method": "splines around second-order responses, errors calibrated by leaving flown primitives out",
        "grown_from": {"name": library.name, "sha256": library_hash(library)},
        "deviations_of": library.provenance.get("deviations_of", "true"),
        **({} if ordered is None else {"coasting_times_ordered": ordered}),
        "left_out": {one.number: one.cross_validation_error for one in fits},
    }
