"""A walk whose errors move on their own, and where it may end for all errors in a box.

Each error variable, from -1 to 1, scales the signed errors of one primitive, or of one scalar of it, times a
level. The end of a walk is a sum of stretches, each turned by the heading before it. With the heading off by
f and a stretch a longer by b, exp(i f) (a + b) differs from its linearisation a + b + i f a by at most
f^2 |a| / 2 + |f| |b|: that holds for errors of any size, and is all that the enclosure needs.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Complex, Float

from flight.library import Library

from .kernel.tables import Table, fold
from .sequences import Walk

Each = Literal["primitive", "scalar"]
"""What has an error variable of its own."""

SERIES = 0.5
"""Radians below which integrals over a turn are taken from their series."""


@dataclass(frozen=True, slots=True, eq=False)
class ErrorPath:
    """The numbers of a walk: nominal values, and what each error variable adds.

    Attributes:
        walk: trim ids.
        names: of the variables.
        velocity: forward + i side in metres per second, and its change with each variable; `rate`,
            `displacement` and `turn` likewise, in radians per second, metres and radians.
        rate: yaw rates.
        displacement: of the maneuvers, in the body frame at entry.
        turn: heading changes of the maneuvers.
        fixed: seconds in maneuvers, and their change with each variable.
    """

    walk: Walk
    names: tuple[str, ...]
    velocity: tuple[Complex[np.ndarray, "trims"], Complex[np.ndarray, "trims variables"]]
    rate: tuple[Float[np.ndarray, "trims"], Float[np.ndarray, "trims variables"]]
    displacement: tuple[Complex[np.ndarray, "steps"], Complex[np.ndarray, "steps variables"]]
    turn: tuple[Float[np.ndarray, "steps"], Float[np.ndarray, "steps variables"]]
    fixed: tuple[float, Float[np.ndarray, "variables"]]

    def at(self, errors: Float[np.ndarray, "n variables"]) -> "Numbers":
        """Returns the numbers for some choices of the error variables."""
        return Numbers(
            self.velocity[0] + errors @ self.velocity[1].T,
            self.rate[0] + errors @ self.rate[1].T,
            self.displacement[0] + errors @ self.displacement[1].T,
            self.turn[0] + errors @ self.turn[1].T,
            self.fixed[0] + errors @ self.fixed[1],
        )

    def table(
        self, errors: Float[np.ndarray, "n variables"], least: Float[np.ndarray, "n trims"] | None = None
    ) -> Table:
        """Returns some choices of the error variables as a table of the exact search.

        Args:
            errors: the choices.
            least: seconds that each trim is held at least, of walks of two trims or more; the times of the
                table come on top.
        """
        numbers = self.at(errors)
        displacement, turn, fixed = numbers.displacement, numbers.turn, numbers.fixed
        if least is not None:
            # Within a coast it does not matter which part comes first: one becomes part of the next maneuver.
            angle = numbers.rate * least
            coast = numbers.velocity * least * _mean(angle)
            displacement = coast[:, :-1] + np.exp(1j * angle[:, :-1]) * displacement
            turn = angle[:, :-1] + turn
            displacement[:, -1] += np.exp(1j * turn[:, -1]) * coast[:, -1]
            turn[:, -1] += angle[:, -1]
            fixed = fixed + least.sum(axis=1)
        return fold(
            np.tile(np.array(self.walk), (len(errors), 1)),
            velocity=numbers.velocity,
            rate=numbers.rate,
            displacement=displacement,
            turn=turn,
            fixed=fixed,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Numbers:
    """The numbers of a walk for some choices of its error variables."""

    velocity: Complex[np.ndarray, "n trims"]
    rate: Float[np.ndarray, "n trims"]
    displacement: Complex[np.ndarray, "n steps"]
    turn: Float[np.ndarray, "n steps"]
    fixed: Float[np.ndarray, "n"]

    def end(self, times: Float[np.ndarray, "n trims"]) -> Complex[np.ndarray, "n"]:
        """Returns where coasting times lead, from the origin heading north, north + i east in metres."""
        return _flown(self, times).end


@dataclass(frozen=True, slots=True, eq=False)
class _Flown:
    facing: Complex[np.ndarray, "n trims"]
    leaving: Complex[np.ndarray, "n steps"]
    mean: Complex[np.ndarray, "n trims"]
    entry: Complex[np.ndarray, "n trims"]
    exit: Complex[np.ndarray, "n trims"]
    end: Complex[np.ndarray, "n"]


def _flown(numbers: Numbers, times: Float[np.ndarray, "n trims"]) -> _Flown:
    angle = numbers.rate * times
    mean = _mean(angle)
    nothing = np.zeros((len(times), 1))
    turned = np.hstack([nothing, np.cumsum(numbers.turn, axis=1)])
    before = np.cumsum(angle, axis=1) - angle
    facing = np.exp(1j * (before + turned))
    leaving = np.exp(1j * (before + angle + turned)[:, :-1])
    coast = facing * numbers.velocity * times * mean
    step = np.hstack([nothing, leaving * numbers.displacement])
    exit_ = np.cumsum(coast + step, axis=1)
    return _Flown(facing, leaving, mean, exit_ - coast, exit_, exit_[:, -1])


@dataclass(frozen=True, slots=True, eq=False)
class Enclosure:
    """Where a walk may end for all errors in boxes: middle + slope . offset, give or take a radius.

    Attributes:
        middle: north + i east in metres.
        slope: metres for each error variable.
        radius: metres.
        along: how fast the end moves with each coasting time at the middle, metres per second.
        influence: metres of radius that each variable is roughly to blame for.
    """

    middle: Complex[np.ndarray, "n"]
    slope: Complex[np.ndarray, "n variables"]
    radius: Float[np.ndarray, "n"]
    along: Complex[np.ndarray, "n trims"]
    influence: Float[np.ndarray, "n variables"]


def enclose(
    path: ErrorPath,
    errors: Float[np.ndarray, "n variables"],
    width: Float[np.ndarray, "n variables"],
    times: Float[np.ndarray, "n trims"],
    answer: Float[np.ndarray, "n trims variables"],
) -> Enclosure:
    """Returns where the walk may end for all errors in some boxes.

    Args:
        path: the walk.
        errors: middles of the boxes.
        width: half widths of the boxes.
        times: coasting times at the middles, seconds.
        answer: by how many seconds the coasting times change with each error variable.
    """
    numbers = path.at(errors)
    flown = _flown(numbers, times)
    velocity, rate = numbers.velocity[:, :, None], numbers.rate[:, :, None]
    moved = times[:, :, None] * path.velocity[1] + velocity * answer
    turned = times[:, :, None] * path.rate[1] + rate * answer
    stretch = numbers.velocity * times
    arm = 1j * (flown.end[:, None] - flown.exit)
    swing = flown.facing * stretch * 1j * _first_moment(numbers.rate * times) + arm
    hinge = 1j * (flown.end[:, None] - flown.entry)[:, 1:]
    slope = (
        np.einsum("nt,ntv->nv", flown.facing * flown.mean, moved)
        + np.einsum("nt,ntv->nv", swing, turned)
        + np.einsum("ns,sv->nv", flown.leaving, path.displacement[1])
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
    way = np.abs(stretch).sum(axis=1) + np.abs(numbers.displacement).sum(axis=1)
    influence = width * (np.abs(after).max(axis=1) * way[:, None] + np.abs(slope))
    along = flown.facing * np.exp(1j * numbers.rate * times) * numbers.velocity + numbers.rate * arm
    return Enclosure(flown.end, slope, radius, along, influence)


def error_path(library: Library, walk: Walk, gamma: float, each: Each) -> ErrorPath:
    """Returns a walk with an error variable for each primitive, or for each scalar that has an error.

    Args:
        library: the primitives.
        walk: trim ids.
        gamma: what the variables, from -1 to 1, scale.
        each: what has a variable of its own. The same primitive flown twice errs independently.

    Raises:
        NoManeuverError: the library does not join two trims of the walk.
    """
    trims, steps = [library.trim(trim) for trim in walk], library.maneuvers_along(walk)
    names: list[str] = []
    errors: list[tuple[str, int, complex]] = []
    owners: list[int] = []
    for place, trim in enumerate(trims):
        if place:
            step = steps[place - 1]
            parts = {
                "duration": ("fixed", step.error.duration),
                "forward": ("displacement", step.error.forward),
                "side": ("displacement", 1j * step.error.side),
                "heading change": ("turn", step.error.heading_change),
            }
            _note(f"maneuver {step.id}", place - 1, parts, each, (names, errors, owners))
        parts = {
            "forward": ("velocity", trim.error.forward),
            "side": ("velocity", 1j * trim.error.side),
            "yaw rate": ("rate", trim.error.yaw_rate),
        }
        _note(f"trim {trim.id}", place, parts, each, (names, errors, owners))
    sizes = {
        "velocity": len(trims),
        "rate": len(trims),
        "displacement": len(steps),
        "turn": len(steps),
        "fixed": 1,
    }
    changes = {kind: np.zeros((size, len(names)), dtype=complex) for kind, size in sizes.items()}
    for (kind, place, error), owner in zip(errors, owners, strict=True):
        changes[kind][0 if kind == "fixed" else place, owner] += gamma * error
    return ErrorPath(
        walk,
        tuple(names),
        (np.array([complex(one.velocity.forward, one.velocity.side) for one in trims]), changes["velocity"]),
        (np.array([one.velocity.yaw_rate for one in trims]), changes["rate"].real),
        (
            np.array([complex(one.displacement.x, one.displacement.y) for one in steps], dtype=complex),
            changes["displacement"],
        ),
        (np.array([one.displacement.heading for one in steps], dtype=float), changes["turn"].real),
        (sum(one.duration for one in steps), changes["fixed"].real[0]),
    )


def _note(
    name: str,
    place: int,
    parts: dict[str, tuple[str, complex]],
    each: Each,
    lists: tuple[list[str], list[tuple[str, int, complex]], list[int]],
) -> None:
    """Adds a primitive's errors to the lists of names, errors and their owners."""
    names, errors, owners = lists
    if each == "primitive":
        names.append(name)
    for part, (kind, error) in parts.items():
        if each == "scalar":
            if error == 0:
                continue
            names.append(f"{name} {part}")
        errors.append((kind, place, error))
        owners.append(len(names) - 1)


def _mean(angle: np.ndarray) -> np.ndarray:
    """Returns the integral of exp(i angle s) over s from 0 to 1."""
    half = 0.5 * angle
    mean: np.ndarray = np.sinc(half / np.pi) * np.exp(1j * half)
    return mean


def _first_moment(angle: np.ndarray) -> np.ndarray:
    """Returns the integral of s exp(i angle s) over s from 0 to 1."""
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
