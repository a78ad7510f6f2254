"""Law of a trim's velocity: between flights, and within a coast."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls

from flight.automaton.joint_law import TrimLaw, VelocityFluctuation
from flight.automaton.trim import Trim
from flight.se2 import Twist
from identification.segmentation.flight_evidence import FlightEvidence

from .digits import matrix3, rounded, row3
from .samples import coasts_of

COASTS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 6.0)
"""Durations in seconds at which the growth of errors is fitted."""

CORRELATION_TIMES = tuple(np.geomspace(0.05, 8.0, 45).tolist())
"""Seconds, tried in turn."""

LEAST_COASTS = 8
"""Coasts of a duration that its variance is taken from, at least."""


def identify_trim_law(trim: Trim, flights: Sequence[FlightEvidence], chosen: Sequence[int]) -> TrimLaw | None:
    """Returns the law of a trim's velocity; None without two flights.

    The variance of the velocity's integral over the first t seconds of a coast is fitted by
    b^2 t^2 + 2 s^2 T (t - T (1 - exp(-t / T))): b between flights, s and T within a coast. Means of flights
    scatter by both, so their deviations are shrunk to the standard deviation b.

    Args:
        trim: the trim.
        flights: evidence in a fixed order.
        chosen: places of the flights whose deviations are kept.
    """
    held = {place: coasts_of(flight, trim.id) for place, flight in enumerate(flights)}
    velocities = {
        place: np.concatenate([coast.velocity for coast in coasts])
        for place, coasts in held.items()
        if coasts
    }
    if len(velocities) < 2:
        return None
    mean = np.concatenate(list(velocities.values())).mean(axis=0)
    integrals = [
        _integral(coast.velocity - mean, coast.duration) for coasts in held.values() for coast in coasts
    ]
    fitted = np.array([_fit_growth(integrals, part) for part in range(3)])
    between, within, times = fitted.T
    means = {place: velocity.mean(axis=0) - mean for place, velocity in velocities.items()}
    rows = np.array(list(means.values()))
    spread = rows.std(axis=0, ddof=1)
    shrunk = np.where(spread > 0, np.minimum(between / np.where(spread > 0, spread, 1.0), 1.0), 0.0)
    covariance = np.cov((rows * shrunk).T)
    places = list(means)
    return TrimLaw(
        mean=Twist(*row3(mean)),
        covariance=matrix3(covariance),
        deviations=tuple(row3(means[_at(place, places)] * shrunk) for place in chosen),
        within=VelocityFluctuation(row3(within), row3(times)),
    )


def _at(place: int, known: Sequence[int]) -> int:
    """Returns the place itself where it is known, else the next known one."""
    return next((one for one in known if one >= place), known[0])


def _integral(
    velocity: Float[np.ndarray, "n 3"], duration: float
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n 3"]]:
    """Returns times since a coast's start and the velocity's integrals."""
    time = np.linspace(0.0, duration, len(velocity))
    steps = (velocity[1:] + velocity[:-1]) / 2 * np.diff(time)[:, None]
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
