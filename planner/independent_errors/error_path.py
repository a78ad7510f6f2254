"""A walk with independent errors.

Each error variable, from -1 to 1, scales the signed errors of one primitive, or of one scalar of it, times a
level.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Complex, Float

from flight.automaton.library import Library
from planner.kernel.tables import KernelTable, kernel_table
from planner.walks.flow import WalkFlow, fly_walks, fold_turns, mean_direction
from planner.walks.walk import Walk

ErrorGranularity = Literal["primitive", "scalar"]
"""Granularity of the error variables."""


@dataclass(frozen=True, slots=True, eq=False)
class ErrorPath:
    """Coefficients of a walk: nominal values and error sensitivities.

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

    def with_single_gamma(self) -> "ErrorPath":
        """Returns the walk with one variable for all errors, as with gamma."""

        def sum_(change: np.ndarray) -> np.ndarray:
            return np.asarray(change.sum(axis=-1, keepdims=True))

        return ErrorPath(
            self.walk,
            ("gamma",),
            (self.velocity[0], sum_(self.velocity[1])),
            (self.rate[0], sum_(self.rate[1])),
            (self.displacement[0], sum_(self.displacement[1])),
            (self.turn[0], sum_(self.turn[1])),
            (self.fixed[0], sum_(self.fixed[1])),
        )

    def turns(self, place: int) -> bool:
        """Returns True if a trim turns for all errors."""
        return bool(np.abs(self.rate[0][place]) > 2 * np.abs(self.rate[1][place]).sum())

    def at(self, errors: Float[np.ndarray, "n variables"]) -> "WalkCoefficients":
        """Returns the coefficients for some choices of the error variables."""
        return WalkCoefficients(
            self.velocity[0] + errors @ self.velocity[1].T,
            self.rate[0] + errors @ self.rate[1].T,
            self.displacement[0] + errors @ self.displacement[1].T,
            self.turn[0] + errors @ self.turn[1].T,
            self.fixed[0] + errors @ self.fixed[1],
        )

    def table(
        self, errors: Float[np.ndarray, "n variables"], least: Float[np.ndarray, "n trims"] | None = None
    ) -> KernelTable:
        """Returns choices of the error variables as an exact-search table.

        Args:
            errors: the choices.
            least: seconds that each trim is held at least, of walks of two trims or more; the times of the
                table come on top.
        """
        numbers = self.at(errors)
        displacement, turn, fixed = numbers.displacement, numbers.turn, numbers.fixed
        if least is not None:
            # The order within a coast is free, so a part of it joins the next maneuver.
            angle = numbers.rate * least
            coast = numbers.velocity * least * mean_direction(angle)
            displacement = coast[:, :-1] + np.exp(1j * angle[:, :-1]) * displacement
            turn = angle[:, :-1] + turn
            displacement[:, -1] += np.exp(1j * turn[:, -1]) * coast[:, -1]
            turn[:, -1] += angle[:, -1]
            fixed = fixed + least.sum(axis=1)
        return kernel_table(
            np.tile(np.array(self.walk), (len(errors), 1)),
            velocity=numbers.velocity,
            rate=numbers.rate,
            displacement=displacement,
            turn=turn,
            fixed=fixed,
        )


@dataclass(frozen=True, slots=True, eq=False)
class WalkCoefficients:
    """Coefficients of a walk for some choices of its error variables."""

    velocity: Complex[np.ndarray, "n trims"]
    rate: Float[np.ndarray, "n trims"]
    displacement: Complex[np.ndarray, "n steps"]
    turn: Float[np.ndarray, "n steps"]
    fixed: Float[np.ndarray, "n"]

    def end(self, times: Float[np.ndarray, "n trims"]) -> Complex[np.ndarray, "n"]:
        """Returns the ends as north + i east in metres."""
        return self.flow(times)[0].end

    def flow(self, times: Float[np.ndarray, "n trims"]) -> tuple[WalkFlow, Float[np.ndarray, "n trims"]]:
        """Returns the flow, and the heading change of earlier maneuvers."""
        nothing = np.zeros((len(times), 1))
        displacement, turn = np.hstack([nothing, self.displacement]), np.hstack([nothing, self.turn])
        velocity, displacement, turned = fold_turns(self.velocity, displacement, turn)
        return fly_walks(velocity, self.rate, displacement, times), turned


def error_path(library: Library, walk: Walk, gamma: float, each: ErrorGranularity) -> ErrorPath:
    """Returns a walk with one error variable per primitive or scalar.

    Args:
        library: the primitives.
        walk: trim ids.
        gamma: scale of the error variables from -1 to 1.
        each: granularity of the variables. A primitive flown twice has independent errors.

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
            _add_errors(f"maneuver {step.id}", place - 1, parts, each, (names, errors, owners))
        parts = {
            "forward": ("velocity", trim.error.forward),
            "side": ("velocity", 1j * trim.error.side),
            "yaw rate": ("rate", trim.error.yaw_rate),
        }
        _add_errors(f"trim {trim.id}", place, parts, each, (names, errors, owners))
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


def _add_errors(
    name: str,
    place: int,
    parts: dict[str, tuple[str, complex]],
    each: ErrorGranularity,
    lists: tuple[list[str], list[tuple[str, int, complex]], list[int]],
) -> None:
    """Appends the errors of a primitive to names, errors and owners."""
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
