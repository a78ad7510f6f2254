"""Symbolic end of a walk: twin of `planner.walks.kinematics.WalkMotion`.

It takes the walk's numbers as symbols, so that one statement serves every walk of the same length.
"""

from dataclasses import dataclass

import casadi


@dataclass(frozen=True, slots=True)
class SymbolicMotion:
    """A walk of so many trims whose numbers are symbols.

    Attributes:
        velocities: 3 x n; forward, side, yaw rate.
        displacements: 3 x (n - 1); forward, side, heading change.
        start: 3; north, east, heading.
        coasting_times: n.
        end: 3; north, east, heading after the walk.
    """

    velocities: casadi.SX
    displacements: casadi.SX
    start: casadi.SX
    coasting_times: casadi.SX
    end: casadi.SX


def symbolic_motion(trims: int) -> SymbolicMotion:
    """States the end of a walk in CasADi: the twin of `WalkMotion.end`."""
    velocities = casadi.SX.sym("velocities", 3, trims)
    displacements = casadi.SX.sym("displacements", 3, trims - 1)
    start = casadi.SX.sym("start", 3)
    times = casadi.SX.sym("coasting_times", trims)
    pose = start
    for place in range(trims):
        if place:
            pose = _compose(pose, displacements[:, place - 1])
        pose = _compose(pose, _exp(velocities[:, place], times[place]))
    return SymbolicMotion(velocities, displacements, start, times, pose)


def _exp(velocity: casadi.SX, time: casadi.SX) -> casadi.SX:
    """The flow of `SE2.exp`, by the same formula."""
    forward, side, rate = velocity[0], velocity[1], velocity[2]
    half = 0.5 * rate * time
    along, across = time * _sinc(2 * half), time * casadi.sin(half) * _sinc(half)
    return casadi.vertcat(forward * along - side * across, forward * across + side * along, rate * time)


def _sinc(angle: casadi.SX) -> casadi.SX:
    """Returns sin(x) / x as a symbol, with slope 0 at 0."""
    return casadi.if_else(angle == 0, 1, casadi.sin(angle) / casadi.if_else(angle == 0, 1, angle))


def _compose(pose: casadi.SX, displacement: casadi.SX) -> casadi.SX:
    c, s = casadi.cos(pose[2]), casadi.sin(pose[2])
    return casadi.vertcat(
        pose[0] + c * displacement[0] - s * displacement[1],
        pose[1] + s * displacement[0] + c * displacement[1],
        pose[2] + displacement[2],
    )
