"""Enclosure of a walk's end over a box of errors.

The end of a walk is a sum of displacements, each rotated by the heading before it. With a heading error f and
a displacement a longer by b, exp(i f) (a + b) differs from its linearisation a + b + i f a by at most
f^2 |a| / 2 + |f| |b|: that holds for errors of any size, and is all that the enclosure needs.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from .error_path import ErrorPath

SERIES = 0.5
"""Radians below which integrals over a turn are taken from their series."""


@dataclass(frozen=True, slots=True, eq=False)
class Enclosure:
    """Enclosure of ends: middle + slope . offset, plus a radius.

    Attributes:
        middle: north + i east in metres.
        slope: metres for each error variable.
        radius: metres.
        influence: metres of radius attributed to each variable, roughly.
    """

    middle: Complex[np.ndarray, "n"]
    slope: Complex[np.ndarray, "n variables"]
    radius: Float[np.ndarray, "n"]
    influence: Float[np.ndarray, "n variables"]


def enclose_end(
    path: ErrorPath,
    errors: Float[np.ndarray, "n variables"],
    width: Float[np.ndarray, "n variables"],
    times: Float[np.ndarray, "n trims"],
    answer: Float[np.ndarray, "n trims variables"],
) -> Enclosure:
    """Returns the enclosure of the walk's end for boxes of errors.

    Args:
        path: the walk.
        errors: middles of the boxes.
        width: half widths of the boxes.
        times: coasting times at the middles, seconds.
        answer: by how many seconds the coasting times change with each error variable.
    """
    numbers = path.at(errors)
    flow, turned_before = numbers.flow(times)
    facing = flow.facing * np.exp(1j * turned_before)
    leaving = flow.facing[:, 1:] * np.exp(1j * turned_before[:, :-1])
    velocity, rate = numbers.velocity[:, :, None], numbers.rate[:, :, None]
    moved = times[:, :, None] * path.velocity[1] + velocity * answer
    turned = times[:, :, None] * path.rate[1] + rate * answer
    stretch = numbers.velocity * times
    arm = 1j * (flow.end[:, None] - flow.exit)
    swing = facing * stretch * 1j * _first_moment(numbers.rate * times) + arm
    hinge = (arm + 1j * facing * stretch * flow.mean)[:, 1:]
    slope = (
        np.einsum("nt,ntv->nv", facing * flow.mean, moved)
        + np.einsum("nt,ntv->nv", swing, turned)
        + np.einsum("ns,sv->nv", leaving, path.displacement[1])
        + np.einsum("ns,sv->nv", hinge, path.turn[1])
    )

    def most(change: np.ndarray) -> Float[np.ndarray, "n places"]:
        sum_: Float[np.ndarray, "n places"] = (np.abs(change) * width[:, None, :]).sum(axis=2)
        return sum_

    longer = most(answer)
    bent = longer * most(path.rate[1][None])
    pushed = longer * most(path.velocity[1][None])
    nothing = np.zeros((len(errors), 1, errors.shape[1]))
    steps = np.concatenate([nothing, np.broadcast_to(path.turn[1], (len(errors), *path.turn[1].shape))], 1)
    after = np.cumsum(turned + steps, axis=1)
    curved = np.cumsum(bent, axis=1)
    off_before = most(after - turned) + curved - bent
    off_after = most(after) + curved
    off_leaving = off_after[:, :-1]
    coasts = np.abs(stretch) * (off_before**2 + off_before * off_after + off_after**2) / 6
    coasts += (most(moved) + pushed) * 0.5 * (off_before + off_after)
    maneuvers = off_leaving * (
        0.5 * np.abs(numbers.displacement) * off_leaving + most(path.displacement[1][None])
    )
    radius = coasts.sum(axis=1) + maneuvers.sum(axis=1) + (pushed + bent * np.abs(swing)).sum(axis=1)
    length = np.abs(stretch).sum(axis=1) + np.abs(numbers.displacement).sum(axis=1)
    influence = width * (np.abs(after).max(axis=1) * length[:, None] + np.abs(slope))
    return Enclosure(flow.end, slope, radius, influence)


def _first_moment(angle: np.ndarray) -> np.ndarray:
    """Returns the integral of `s exp(i angle s)` over [0, 1]."""
    small = np.abs(angle) < SERIES
    x = 1j * np.where(small, angle, 0.0)
    term, series = np.ones_like(x), np.zeros_like(x)
    for power in range(18):
        series = series + term / (power + 2)
        term = term * x / (power + 1)
    safe = np.where(small, 1.0, angle)
    exact = np.exp(1j * safe) / (1j * safe) + (np.exp(1j * safe) - 1) / safe**2
    moment: np.ndarray = np.where(small, series, exact)
    return moment
