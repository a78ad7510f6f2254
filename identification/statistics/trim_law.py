"""Law of a trim's velocity: between flights, and within a coast."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls

from flight.automaton.joint_law import TrimLaw, VelocityFluctuation
from flight.automaton.trim import Trim
from flight.se2 import Twist
from identification.segmentation.flight_evidence import FlightEvidence
from identification.segmentation.segmentation import CoastSegment

from .coverage import joint_coverage
from .digits import matrix3, rounded, rounded_down, rounded_up, row3
from .samples import TRIM_SCALARS, coasts_of

COASTS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 6.0)
"""Durations in seconds at which the growth of errors is fitted."""

CORRELATION_TIMES = tuple(np.geomspace(0.05, 8.0, 45).tolist())
"""Seconds, tried in turn."""

LEAST_COASTS = 8
"""Coasts of a duration that its variance is taken from, at least."""


def identify_trim_law(
    trim: Trim,
    *,
    bounding: Sequence[FlightEvidence],
    nominal: Sequence[FlightEvidence],
    chosen: Sequence[int],
    discarded: int,
    confidence: float,
) -> TrimLaw | None:
    """Returns the law of a trim's velocity; None without two flights.

    The variance of the velocity's integral over the first t seconds of a coast is fitted by
    b^2 t^2 + 2 s^2 T (t - T (1 - exp(-t / T))): b between flights, s and T within a coast. Means of flights
    scatter by both, so their deviations are shrunk to the standard deviation b. Mean and growth are those of
    the nominal flights, so that bounds of the others in standard deviations have one fitted value a scalar;
    without nominal flights they are those of all, and no coverage is claimed.

    Args:
        trim: the trim.
        bounding: flights for the bounds, in a fixed order.
        nominal: flights for the values.
        chosen: places, in bounding and nominal flights, of those whose deviations are kept.
        discarded: samples outside the bounds.
        confidence: confidence of the coverage.
    """
    flights = [*bounding, *nominal]
    held = [coasts_of(flight, trim.id) for flight in flights]
    learnt = held[len(bounding) :] if nominal else held
    samples = [np.concatenate([coast.velocity for coast in coasts]) for coasts in learnt if coasts]
    if len(samples) < 2:
        return None
    mean = np.array(row3(np.concatenate(samples).mean(axis=0)))
    integrals = [_integral(coast, mean) for coasts in learnt for coast in coasts]
    between, within, times = np.array([_fit_growth(integrals, part) for part in range(3)]).T
    means = {
        place: np.concatenate([coast.velocity for coast in coasts]).mean(axis=0) - mean
        for place, coasts in enumerate(held)
        if coasts
    }
    rows = np.array(list(means.values()))
    spread = rows.std(axis=0, ddof=1)
    shrunk = np.where(spread > 0, np.minimum(between / np.where(spread > 0, spread, 1.0), 1.0), 0.0)
    places = list(means)
    law = TrimLaw(
        mean=Twist(*mean.tolist()),
        covariance=matrix3(np.outer(between, between) * _correlation(rows)),
        deviations=tuple(row3(means[_at(place, places)] * shrunk) for place in chosen),
        within=VelocityFluctuation(row3(within), row3(times)),
    )
    if not nominal:
        return law
    largest = [growth_ratios(coasts, law) for coasts in held[: len(bounding)] if coasts]
    known = [ratios for ratios in largest if ratios is not None]
    if not known:
        return law
    coverage = joint_coverage(
        len(known) + discarded, support=len(TRIM_SCALARS), confidence=confidence, discarded=discarded
    )
    bounds = row3(map(rounded_up, np.max(known, axis=0).tolist()))
    return replace(law, bounds=bounds, coverage=rounded_down(coverage))


def growth_ratios(coasts: Sequence[CoastSegment], law: TrimLaw) -> Float[np.ndarray, "3"] | None:
    """Returns the largest errors of coasts in standard deviations of their growth.

    None where no coast is longer than a control period.
    """
    mean = np.array([law.mean.forward, law.mean.side, law.mean.yaw_rate])
    largest = []
    for coast in coasts:
        time, way = _integral(coast, mean)
        spread = np.array([law.standard_deviation_after(float(one)) for one in time[1:]])
        # A component that never deviated has no scale; any deviation is outside.
        scaled = np.abs(way[1:]) / np.where(spread > 0, spread, 1e-12)
        largest.append(scaled.max(axis=0))
    return np.asarray(np.max(largest, axis=0)) if largest else None


def _correlation(rows: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3 3"]:
    """Returns the correlation of columns; none with a constant one."""
    covariance = np.cov(rows.T)
    spread = np.sqrt(np.diag(covariance))
    sizes = np.outer(spread, spread)
    found = np.where(sizes > 0, covariance / np.where(sizes > 0, sizes, 1.0), 0.0)
    np.fill_diagonal(found, 1.0)
    return np.asarray(found)


def _at(place: int, known: Sequence[int]) -> int:
    """Returns a place if known, else the next known one."""
    return next((one for one in known if one >= place), known[0])


def _integral(
    coast: CoastSegment, mean: Float[np.ndarray, "3"]
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n 3"]]:
    """Returns times since a coast's start and the integrals of its deviations."""
    off = coast.velocity - mean
    time = np.linspace(0.0, coast.duration, len(off))
    steps = (off[1:] + off[:-1]) / 2 * np.diff(time)[:, None]
    return time, np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])


def _fit_growth(
    integrals: Sequence[tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n 3"]]], part: int
) -> tuple[float, float, float]:
    """Returns b, s and T of one component."""
    coasts, variances, counts = [], [], []
    for coast in COASTS:
        values = [np.interp(coast, time, way[:, part]) for time, way in integrals if time[-1] >= coast]
        if len(values) >= LEAST_COASTS:
            coasts.append(coast)
            variances.append(float(np.mean(np.square(values))))
            counts.append(len(values))
    if not coasts or min(variances) <= 0:
        return 0.0, 0.0, 1.0
    time, known = np.array(coasts), np.array(variances)
    # Relative errors of variances, each weighted by its sample.
    weight = np.sqrt(counts) / known
    fits = []
    for correlation in CORRELATION_TIMES:
        grown = 2 * correlation * (time - correlation * (1 - np.exp(-time / correlation)))
        (between, within), residual = nnls(
            np.column_stack([time**2, grown]) * weight[:, None], known * weight
        )
        fits.append((rounded(float(residual)), correlation, between, within))
    _, correlation, between, within = min(fits)
    return float(np.sqrt(between)), float(np.sqrt(within)), correlation
