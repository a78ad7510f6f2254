"""Checks of the integration: closed forms, order and smaller steps."""

from collections.abc import Iterator
from dataclasses import replace
from math import log2, sqrt, tanh

import mujoco
import numpy as np

from flight.se2 import Twist
from flight.units import FOOT
from sim.loop.motion import Motion
from sim.vehicle.helicopter import DEFAULT_STEP
from sim.vehicle.mujoco_model import load_model
from sim.vehicle.parameters import Parameters

from .check_result import CheckResult
from .velocity_response import simulate_response

# Sixty seconds with all kinds of change, in ft/s and rad/s.
_FLIGHT = tuple(
    (Twist(speed * FOOT, 0.0, rate), 7.5)
    for speed, rate in ((0, 0.0), (3, 0.0), (10, 0.0), (10, 0.6), (10, 0.0), (3, -0.3), (3, 0.0), (0, 0.0))
)


def check_numerics(parameters: Parameters, *, displacement_error: float) -> Iterator[CheckResult]:
    """Yields the errors and orders of the integration.

    Args:
        parameters: vehicle.
        displacement_error: median identified error of the library's maneuvers, m.
    """
    closed = "against the closed form"
    coarse, fine = (tumbling_error(parameters, DEFAULT_STEP / share) for share in (1, 8))
    yield CheckResult(
        "numerics", "torque-free tumbling, 5 s, error", coarse, "rad/s", high=0.02, beside=closed
    )
    yield CheckResult("numerics", "tumbling, fitted order", log2(coarse / fine) / 3.0, "-", 0.9, 2.5)
    coarse, fine = (falling_error(parameters, DEFAULT_STEP / share) for share in (1, 8))
    yield CheckResult("numerics", "drop with drag, 5 s, error", coarse, "m/s", high=0.02, beside=closed)
    yield CheckResult("numerics", "drop, fitted order", log2(coarse / fine) / 3.0, "-", 0.9, 2.5)
    ends = [final_position(parameters, DEFAULT_STEP / share) for share in (1, 2, 8)]
    off, halved = (float(np.hypot(*(end - ends[-1]))) for end in ends[:2])
    beside = "60 s, still air, ideal sensors; limit: a tenth of the median identified displacement error"
    high = 0.1 * displacement_error
    yield CheckResult("numerics", "final position, step against step / 8", off, "m", high=high, beside=beside)
    yield CheckResult("numerics", "flight, fitted order", fitted_order(off, halved), "-")


def fitted_order(off: float, halved: float) -> float:
    """Returns the order from errors at h and h/2 against h/8."""
    orders = np.linspace(0.2, 6.0, 2000)
    ratios = (1.0 - 8.0**-orders) / (2.0**-orders - 8.0**-orders)
    return float(orders[np.argmin(np.abs(ratios - off / halved))])


def tumbling_error(parameters: Parameters, step: float) -> float:
    """Returns the final rate error of a free symmetric body, rad/s.

    Euler's solution: with moments of inertia A, A, C the rate r is constant and (p, q) rotates at (C - A) / A
    r.
    """
    body = replace(parameters.body, inertia_yy=parameters.body.inertia_xx, inertia_xz=0.0)
    model = load_model(replace(parameters, body=body), step)
    model.opt.gravity[:] = 0.0
    data = mujoco.MjData(model)
    start = np.array([0.5, 0.3, -1.0])
    data.qpos[2], data.qvel[3:] = 1e3, start
    steps = round(5.0 / step)
    mujoco.mj_step(model, data, nstep=steps)
    turn = (body.inertia_zz - body.inertia_xx) / body.inertia_xx * start[2] * steps * step
    c, s = np.cos(turn), np.sin(turn)
    expected = np.array([c * start[0] - s * start[1], s * start[0] + c * start[1], start[2]])
    return float(np.abs(data.qvel[3:] - expected).max())


def falling_error(parameters: Parameters, step: float) -> float:
    """Returns the final speed error of a falling body, m/s.

    Closed form: v = v_t tanh(g t / v_t). The drag is held through each step, as the rotor's loads are.
    """
    model = load_model(parameters, step)
    data = mujoco.MjData(model)
    data.qpos[2] = 1e4
    mass, gravity = parameters.body.mass, parameters.environment.gravity
    drag = parameters.environment.air_density / 2.0 * parameters.airframe.plate_top
    steps = round(5.0 / step)
    for _ in range(steps):
        speed = -data.qvel[2]
        data.xfrc_applied[1, 2] = drag * speed * abs(speed)
        mujoco.mj_step(model, data)
    last = sqrt(mass * gravity / drag)
    return float(abs(-data.qvel[2] - last * tanh(gravity * steps * step / last)))


def final_position(parameters: Parameters, step: float) -> np.ndarray:
    """Returns the final north and east of a 60 s flight, m."""
    flown = simulate_response(_FLIGHT, vehicle=parameters, plant_step=step)
    return np.array([flown.column(name)[-1] for name in Motion._fields[:2]])
