"""Gain and phase margins with one loop broken at a time.

The plant is discretised exactly for commands held over a control period and delayed by whole periods; the
controller is linearised at the trim, with the network's weights frozen.
"""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from jaxtyping import Complex, Float
from scipy.linalg import expm

from flight.se2 import Twist
from sim.control.controller import Controller, initial_controller_state
from sim.control.trim_table import TrimPoint, trim_table
from sim.loop.motion import Controls, Motion
from sim.vehicle.equilibrium import EquilibriumFinder
from sim.vehicle.linearisation import LinearMotion, linearise
from sim.vehicle.parameters import Parameters

PATHS = (*Controls._fields, "forward", "side", "descent", "roll", "pitch", "yaw_rate")
"""Points at which the loop is broken: servo commands and estimated quantities."""

# From below the slowest crossover to the Nyquist frequency, dense enough to separate the crossovers.
_SLOWEST, _POINTS = 0.02, 3000


@dataclass(frozen=True, slots=True)
class Margins:
    """Stability margins of one path.

    Attributes:
        gain: gain margin, up or down, dB.
        phase: phase margin, lag or lead, deg.
        delay: delay margin, s.
        crossover: highest frequency of gain one, rad/s.
    """

    gain: float
    phase: float
    delay: float
    crossover: float


@dataclass(frozen=True, slots=True, eq=False)
class Loop:
    """Sampled plant and controller in state space.

    Attributes:
        plant: A, B, C, D from servo commands to estimate.
        controller: A, B, C, D from estimate to servo commands.
        step: sampling period, s.
        delay: delay between them, periods.
    """

    plant: tuple[Float[np.ndarray, "..."], ...]
    controller: tuple[Float[np.ndarray, "..."], ...]
    step: float
    delay: int


def close_loop(
    vehicle: Parameters,
    controller: Controller,
    controller_model: Parameters,
    velocity: Twist,
    *,
    height: float,
    step: float,
) -> Loop:
    """Returns the loop of a vehicle at a trim.

    Args:
        vehicle: vehicle flown.
        controller: controller to linearise.
        controller_model: vehicle that the controller is designed for.
        velocity: velocity of the trim.
        height: height held, m.
        step: control period, s.
    """
    motion = linearise(vehicle, EquilibriumFinder(vehicle).find(velocity))
    trim = trim_table(controller_model).at(velocity.forward, velocity.yaw_rate)
    return Loop(
        plant=_discretise(motion, step),
        controller=_linearise_controller(controller, trim, velocity, height=height),
        step=step,
        delay=round(vehicle.servos.delay / step),
    )


def is_stable(loop: Loop, *, extra_delay: int = 0) -> bool:
    """Returns True if all eigenvalues of the closed loop are stable."""
    a, b, c, _ = loop.plant
    ka, kb, kc, kd = loop.controller
    n, m, waiting = len(a), len(ka), loop.delay + extra_delay
    size = n + 4 * waiting + m
    whole = np.zeros((size, size))
    whole[:n, :n] = a
    command = np.zeros((4, size))
    command[:, :n] = kd @ c
    command[:, n + 4 * waiting :] = kc
    if waiting:
        whole[:n, n : n + 4] = b
        for place in range(waiting - 1):
            at = n + 4 * place
            whole[at : at + 4, at + 4 : at + 8] = np.eye(4)
        whole[n + 4 * (waiting - 1) : n + 4 * waiting] = command
    else:
        whole[:n] += b @ command
    whole[n + 4 * waiting :, :n] = kb @ c
    whole[n + 4 * waiting :, n + 4 * waiting :] = ka
    # Weights and heading are marginally stable: eigenvalues of one.
    return bool(np.abs(np.linalg.eigvals(whole)).max() < 1.0 + 1e-7)


def compute_margins(loop: Loop) -> dict[str, Margins]:
    """Returns the margins of every path by its name in `PATHS`."""
    frequencies = np.geomspace(_SLOWEST, np.pi / loop.step, _POINTS)
    plant, controller = _responses(loop, frequencies)
    identity = np.eye(4)
    closed = np.linalg.det(identity - controller @ plant)
    found = {}
    for path in PATHS:
        cut = controller.copy()
        if path in Controls._fields:
            cut[:, Controls._fields.index(path), :] = 0.0
        else:
            cut[:, :, Motion._fields.index(path)] = 0.0
        found[path] = read_margins(frequencies, closed / np.linalg.det(identity - cut @ plant) - 1.0)
    return found


def read_margins(frequencies: Float[np.ndarray, "n"], response: Complex[np.ndarray, "n"]) -> Margins:
    """Returns the margins of an open-loop response under negative feedback."""
    size, angle = np.abs(response), np.unwrap(np.angle(response))
    crossing = np.nonzero(np.diff(np.sign(size - 1.0)))[0]
    # Distance of the phase to the nearest odd multiple of pi, at gain one.
    phase = np.abs(np.remainder(angle[crossing], 2.0 * np.pi) - np.pi)
    lag = np.remainder(angle[crossing] - np.pi, 2.0 * np.pi)
    turned = np.floor((angle - np.pi) / (2.0 * np.pi))
    opposite = np.nonzero(np.diff(turned))[0]
    gain = np.abs(20.0 * np.log10(size[opposite]))
    return Margins(
        gain=float(gain.min(initial=np.inf)),
        phase=float(np.degrees(phase.min(initial=np.pi))),
        delay=float((lag / frequencies[crossing]).min(initial=np.inf)),
        crossover=float(frequencies[crossing].max(initial=0.0)),
    )


def _discretise(motion: LinearMotion, step: float) -> tuple[Float[np.ndarray, "..."], ...]:
    n = len(motion.state)
    whole = np.zeros((n + 4, n + 4))
    whole[:n, :n], whole[:n, n:] = motion.state, motion.control
    stepped = expm(step * whole)
    return stepped[:n, :n], stepped[:n, n:], motion.output, np.zeros((13, 4))


def _linearise_controller(
    controller: Controller, trim: TrimPoint, velocity: Twist, *, height: float
) -> tuple[Float[np.ndarray, "..."], ...]:
    function = controller.function
    estimate, reference, learning, state = function.sx_in()
    controls, after = function(estimate, reference, learning, state)
    parts = [ca.jacobian(out, by) for out, by in ((after, state), (after, estimate), (controls, state))] + [
        ca.jacobian(controls, estimate)
    ]
    jacobians = ca.Function("slopes", [estimate, reference, learning, state], parts)
    turn = velocity.yaw_rate
    level = (0.0, 0.0, -height, velocity.forward, velocity.side, 0.0, trim.roll, trim.pitch, 0.0)
    rates = (
        -turn * np.sin(trim.pitch),
        turn * np.sin(trim.roll) * np.cos(trim.pitch),
        turn * np.cos(trim.roll) * np.cos(trim.pitch),
    )
    target = (velocity.forward, 0.0, 0.0, velocity.side, 0.0, 0.0, turn, 0.0, 0.0, *trim)
    return tuple(
        np.array(part)
        for part in jacobians(
            ca.DM([*level, *rates, turn]), ca.DM(target), 0.0, initial_controller_state(trim)
        )
    )


def _responses(
    loop: Loop, frequencies: Float[np.ndarray, "n"]
) -> tuple[Complex[np.ndarray, "n 13 4"], Complex[np.ndarray, "n 4 13"]]:
    turn = np.exp(1j * frequencies * loop.step)
    plant = _response(loop.plant, turn) * turn[:, None, None] ** -loop.delay
    return plant, _response(loop.controller, turn)


def _response(
    system: tuple[Float[np.ndarray, "..."], ...], turn: Complex[np.ndarray, "n"]
) -> Complex[np.ndarray, "n outputs inputs"]:
    a, b, c, d = system
    # Uncontrollable or unobservable states, such as frozen weights, are removed.
    across = np.abs(a - np.diag(np.diag(a)))
    reaching = np.abs(c).sum(axis=0) + across.sum(axis=0)
    reached = np.abs(b).sum(axis=1) + across.sum(axis=1)
    kept = np.nonzero(reaching * reached)[0]
    a, b, c = a[np.ix_(kept, kept)], b[kept], c[:, kept]
    inverse = np.linalg.solve(
        turn[:, None, None] * np.eye(len(a)) - a, np.broadcast_to(b, (len(turn), *b.shape))
    )
    return np.asarray(c @ inverse + d)
