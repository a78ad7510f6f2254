"""Which coasting times nothing nearby can improve: first-order conditions, multipliers written out."""

import numpy as np
from jaxtyping import Bool, Complex, Float

from .batch import Batch
from .starts import Goal, Starts

ACTIVE = 1e-9
"""Seconds above which a coasting time counts as not zero."""

WORTH = 1e-6
"""Seconds a second: how much faster than the flown ones a trim may look before it is worth flying."""

NORMAL = 1e-6
"""Radians by which the multiplier may stand off the edge's normal; costs less than a microsecond."""


def settled(batch: Batch, goal: Goal, starts: Starts) -> Bool[np.ndarray, "found"]:
    """Returns whether coasting times are locally optimal as they stand.

    At a local optimum there is a vector m (s/m) with m . v = -1 for the end velocity v of every time that is
    not zero, m . v >= -1 for the others; and where there is a tolerance, m points along the outward normal of
    its disc. With two such times (one at the edge of the disc) m follows from them; with more, the solver
    decides. A walk that ends inside the disc without coasting cannot be better.

    Args:
        batch: the walks.
        goal: as they were found for.
        starts: the coasting times.
    """
    rows = batch.take(starts.row)
    active = starts.times > ACTIVE
    count = active.sum(axis=1)
    velocity = rows.end_velocities(starts.times)
    two, by_pair = _two_active(velocity, active)
    end, heading = rows.end(starts.times)
    done: Bool[np.ndarray, "found"] = (count == 0) & (goal.detour(heading) == 0)
    if goal.heading is not None:
        # A wanted heading is one condition more; the solver decides.
        return done
    if goal.tolerance == 0:
        return np.asarray(done | (two & _worth_nothing(by_pair, velocity)))
    normal = (end - goal.centre) / goal.tolerance
    with np.errstate(divide="ignore", invalid="ignore"):
        at_edge: Bool[np.ndarray, "found"] = np.abs(np.abs(normal) - 1) < 1e-6
        speed = np.where(active, (np.conj(normal)[:, None] * velocity).real, 0.0).sum(axis=1)
        by_normal = -normal / speed
        along_normal: Bool[np.ndarray, "found"] = np.abs(np.angle(by_pair / normal)) < NORMAL
    one: Bool[np.ndarray, "found"] = (count == 1) & (speed < 0) & _worth_nothing(by_normal, velocity)
    return np.asarray(done | (at_edge & (one | (two & along_normal & _worth_nothing(by_pair, velocity)))))


def _two_active(
    velocity: Complex[np.ndarray, "found trims"], active: Bool[np.ndarray, "found trims"]
) -> tuple[Bool[np.ndarray, "found"], Complex[np.ndarray, "found"]]:
    """Returns which rows have exactly two times that are not zero, and the multiplier of those."""
    rows = np.arange(len(active))
    first = active.argmax(axis=1)
    second = active.shape[1] - 1 - active[:, ::-1].argmax(axis=1)
    one, other = velocity[rows, first], velocity[rows, second]
    with np.errstate(divide="ignore", invalid="ignore"):
        multiplier: Complex[np.ndarray, "found"] = 1j * (other - one) / (np.conj(one) * other).imag
    exactly_two: Bool[np.ndarray, "found"] = active.sum(axis=1) == 2
    return exactly_two & np.isfinite(multiplier), multiplier


def _worth_nothing(
    multiplier: Complex[np.ndarray, "found"], velocity: Complex[np.ndarray, "found trims"]
) -> Bool[np.ndarray, "found"]:
    """Returns whether no trim would pay for its time."""
    with np.errstate(invalid="ignore"):
        worth: Float[np.ndarray, "found trims"] = 1 + (np.conj(multiplier)[:, None] * velocity).real
    return np.asarray((worth >= -WORTH).all(axis=1))
