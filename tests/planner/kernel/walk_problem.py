"""One walk in plain numbers, with independent formulas."""

from cmath import exp
from dataclasses import dataclass
from math import factorial, pi

import numpy as np

from flight.mission.mission import Mission
from flight.se2 import SE2
from planner.kernel.exact import best_times
from planner.kernel.tables import KernelTable, kernel_table

Times = tuple[float, ...]

SMALL = 0.1
"""Radians below which cancelling terms are omitted."""


@dataclass(frozen=True, slots=True)
class WalkProblem:
    """A walk of coasts and maneuvers, and where it is to end.

    Attributes:
        velocities: forward + i side of each coast, metres per second.
        rates: yaw rates, radians per second.
        displacements: of the maneuvers between, in the body frame at entry, metres.
        turns: heading changes of the maneuvers, radians.
        goal: north + i east in metres, seen from the start with heading 0.
        tolerance: metres.
        heading: wanted at the end, radians; None leaves it free.
        heading_tolerance: radians.
    """

    velocities: tuple[complex, ...]
    rates: tuple[float, ...]
    displacements: tuple[complex, ...] = ()
    turns: tuple[float, ...] = ()
    goal: complex = 0j
    tolerance: float = 0.0
    heading: float | None = None
    heading_tolerance: float = pi

    @property
    def steps(self) -> list[tuple[complex, float]]:
        """Returns displacement and heading change of the maneuver before each coast."""
        moved = self.displacements or (0j,) * (len(self.rates) - 1)
        turned = self.turns or (0.0,) * (len(self.rates) - 1)
        return [(0j, 0.0), *zip(moved, turned, strict=True)]

    @property
    def mission(self) -> Mission:
        """Returns the mission to the wanted end."""
        return Mission(
            name="walk",
            start=SE2.identity(),
            start_trim=1,
            goal=(self.goal.real, self.goal.imag),
            tolerance=self.tolerance,
            goal_heading=self.heading,
            heading_tolerance=self.heading_tolerance,
        )

    def end(self, times: Times) -> tuple[complex, float]:
        """Returns position and heading at the end, by integration."""
        position, heading = 0j, 0.0
        for (moved, turned), velocity, rate, time in zip(
            self.steps, self.velocities, self.rates, times, strict=True
        ):
            position += exp(1j * heading) * moved
            heading += turned
            angle = rate * time
            position += exp(1j * heading) * velocity * time * _mean_direction(angle)
            heading += angle
        return position, heading

    def end_velocities(self, times: Times) -> np.ndarray:
        """Returns the end's velocity with each time, in metres per second."""
        position, heading, own, after = 0j, 0.0, [], []
        for (moved, turned), velocity, rate, time in zip(
            self.steps, self.velocities, self.rates, times, strict=True
        ):
            position += exp(1j * heading) * moved
            heading += turned
            position += exp(1j * heading) * velocity * time * _mean_direction(rate * time)
            heading += rate * time
            own.append(exp(1j * heading) * velocity)
            after.append(position)
        return np.array(own) + 1j * np.array(self.rates) * (position - np.array(after))

    def table(self) -> KernelTable:
        """Returns the walk as a kernel table."""
        return kernel_table(
            np.arange(1, len(self.rates) + 1)[None, :],
            velocity=np.array([self.velocities], dtype=complex),
            rate=np.array([self.rates], dtype=float),
            displacement=np.array([[moved for moved, _ in self.steps[1:]]], dtype=complex),
            turn=np.array([[turned for _, turned in self.steps[1:]]], dtype=float),
            fixed=np.zeros(1),
        )

    def solved(self) -> tuple[float, Times]:
        """Returns the kernel's least seconds, or infinity, and coasting times."""
        costs, times = best_times(self.table(), self.mission)
        return float(costs[0]), tuple(times[0].tolist())


def _mean_direction(angle: float) -> complex:
    """Returns the mean of `exp(i s)` over an angle, small ones by series."""
    if abs(angle) > SMALL:
        return (exp(1j * angle) - 1) / (1j * angle)
    return sum((1j * angle) ** power / factorial(power + 1) for power in range(10))
