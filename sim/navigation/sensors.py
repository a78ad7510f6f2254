"""Sensors: inertial unit, GPS with boom antenna, magnetometer and altimeter.

Every reading is the truth with white noise and, for some, a Gauss-Markov error and errors of the
installation. The inertial unit gives the mean over a control period.
"""

from functools import cache
from math import exp, pi
from typing import Protocol

import casadi as ca
import numpy as np
from jaxtyping import Float

from flight.se2 import SE2
from sim.loop.backend import Backend
from sim.loop.bound_function import Recursion
from sim.loop.delay_line import DelayLine
from sim.loop.motion import Motion
from sim.loop.noise import Noise
from sim.loop.signals import Signals

from .filter import (
    conjugate,
    euler_quaternion,
    initial_nominal_function,
    product,
    rotation,
    rotation_vector,
    world_velocity,
)
from .installation import SIZE, Installation
from .sensor_errors import SensorErrors

_MOTION, _DRIFTS, _WHITE_NOISES = len(Motion._fields), 10, 14
# Stored motion of the previous period: velocity and attitude.
_BEFORE = 7
# The last entry of the state is the phase of the vibration.
_NOISE, _STATE = _DRIFTS + _WHITE_NOISES, _BEFORE + _DRIFTS + 1
# Phases of the vibration of the three axes, rad: a hub that shakes in a circle, and up and down.
_PHASES = (0.0, pi / 2.0, pi / 4.0)


Values = Float[np.ndarray, "n"]


class SensorReadings(Protocol):
    """Readings for the filter, as arrays changed in place."""

    inertial: Values
    fix: Values
    heading_and_height: Values
    has_fix: bool
    has_heading_and_height: bool

    @property
    def biases(self) -> Values:
        """Biases of accelerometers and gyros."""

    def run(self) -> None:
        """Reads the sensors at the end of a control period."""

    def move_world(self, displacement: SE2) -> None:
        """Applies a displacement of the whole world."""


@cache
def sensor_function(errors: SensorErrors, step: float, gravity: float) -> ca.Function:
    """Builds the sensor readings of a motion, without latency.

    Returns:
        (motion now, noise, installation, state) -> (inertial reading, antenna position and velocity,
        heading and height, state). The noise drives the Gauss-Markov errors and adds white noise, in the
        units of the readings except for the height; the state is velocity (world) and attitude quaternion of
        the previous period, the Gauss-Markov errors, and the phase of the vibration.
    """
    now, noise, state = ca.SX.sym("now", _MOTION), ca.SX.sym("noise", _NOISE), ca.SX.sym("state", _STATE)
    built = ca.SX.sym("installation", SIZE)
    scale, misalignment, deviation, arm, vibration, phase_step = ca.vertsplit(
        built, (0, 3, 6, 10, 13, 14, 15)
    )
    velocity_before, first, drifts, phase = ca.vertsplit(state, (0, 3, _BEFORE, _STATE - 1, _STATE))
    keep = ca.DM([exp(-step / drift.time) for drift in errors.drifts])
    drifts, white = keep * drifts + noise[:_DRIFTS], noise[_DRIFTS:]
    velocity, last = world_velocity(now), euler_quaternion(now[6:9])
    change = product(conjugate(first), last)
    rates = 2.0 * ca.sign(change[0]) * change[1:] / step
    middle = rotation(product(first, rotation_vector(rates * step / 2.0)))
    acceleration = (velocity - velocity_before) / step
    force = middle.T @ (acceleration - ca.DM([0, 0, gravity]))
    seen = rotation(rotation_vector(misalignment)).T
    phase = ca.remainder(phase + phase_step, 2.0 * pi)
    shaken = seen @ force + vibration * ca.sin(phase + ca.DM(_PHASES))
    turn = rotation(last)
    antenna = ca.vertcat(now[:3] + turn @ arm, velocity + turn @ ca.cross(now[9:12], arm))
    circle = ca.vertcat(ca.sin(now[8]), ca.cos(now[8]), ca.sin(2.0 * now[8]), ca.cos(2.0 * now[8]))
    heading, height = now[8] + (drifts[9] + white[12] + ca.dot(deviation, circle)), -now[2]
    results = [
        ca.vertcat(shaken, (1.0 + scale) * (seen @ rates)) + drifts[:6] + white[:6],
        antenna + white[6:12],
        ca.vertcat(heading, height + errors.height_sigma(height) * white[13]),
        ca.vertcat(velocity, last, drifts, phase),
    ]
    return ca.Function("sense", [now, noise, built, state], ca.cse(results))


class Sensors:
    """Sensors of a vehicle's motion, period by period.

    Args:
        errors: sizes of the errors.
        step: control period, s.
        gravity: gravity, m/s2.
        rng: random generator.
        installation: errors of the airframe's sensors; none but the antenna's place if None.
        signals: input truth, already set to the start.
        backend: numeric back-end.

    Attributes:
        inertial: specific force (m/s2) and body rates (rad/s), mean over the last period.
        fix: antenna position (m) and velocity (m/s) in the world, delayed by the latency.
        heading_and_height: heading in rad, not wrapped, and height above ground in m.
        has_fix: whether this period has a fix.
        has_heading_and_height: whether this period has heading and height.
    """

    def __init__(
        self,
        errors: SensorErrors,
        *,
        step: float,
        gravity: float,
        rng: np.random.Generator,
        installation: Installation | None = None,
        signals: Signals,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        self._errors, self._rng, self._truth = errors, rng, signals.truth
        sigma = np.array([drift.sigma for drift in errors.drifts])
        keep = np.array([exp(-step / drift.time) for drift in errors.drifts])
        self._drive = sigma * np.sqrt(1.0 - keep**2)
        self._white = np.array([*errors.inertial_noise, *errors.fix_noise, errors.heading_noise, 1.0])
        drawn = sigma * rng.standard_normal(_DRIFTS)
        self._state = np.concatenate([np.zeros(_BEFORE), drawn, [0.0]])
        self._drift = self._state[_BEFORE:-1]
        built = installation or Installation((0.0,) * 3, (0.0,) * 3, (0.0,) * 4, errors.antenna, 0.0, 0.0)
        self._installation = built.values()
        self._remember()
        self.inertial, self.fix, self.heading_and_height = np.zeros(6), np.zeros(6), np.zeros(2)
        self.has_fix = self.has_heading_and_height = False
        antenna, noise = np.zeros(6), np.zeros(_NOISE)
        self._sense = Recursion(
            sensor_function(errors, step, gravity),
            (signals.truth, noise, self._installation, self._state),
            (self.inertial, antenna, self.heading_and_height),
            backend=backend,
        )
        self._noise = Noise(noise, self._draw)
        self._fixes = DelayLine((antenna,), periods=errors.fix_latency)
        self._turned = 0.0
        self._period = 0

    @property
    def biases(self) -> np.ndarray:
        """Biases of accelerometers and gyros."""
        return np.asarray(self._drift[:6])

    def move_world(self, displacement: SE2) -> None:
        """Applies a displacement of the world, with the signals' new truth."""
        self._remember()
        self._turned += displacement.heading
        for fix in self._fixes.rows:
            pose = displacement @ SE2(fix[0], fix[1], 0.0)
            velocity = SE2(0.0, 0.0, displacement.heading) @ SE2(fix[3], fix[4], 0.0)
            fix[:2], fix[3:5] = (pose.x, pose.y), (velocity.x, velocity.y)

    def _remember(self) -> None:
        """Stores the truth as that of the previous period."""
        nominal = initial_nominal_function()(self._truth)
        self._state[:_BEFORE] = nominal.elements()[3:10]

    def run(self) -> None:
        """Reads the sensors at the end of a control period."""
        self._noise.next()
        self._sense.step()
        self._fixes.push()
        self._period = period = self._period + 1
        errors = self._errors
        self.has_fix = period % errors.fix_periods == 0 and period > errors.fix_latency
        self.has_heading_and_height = period % errors.slow_periods == 0
        if self.has_fix:
            self._receive()

    def _receive(self) -> None:
        """Outputs the delayed fix with its drift."""
        north, east, down = self._drift[6:9].tolist()
        drift = SE2(0.0, 0.0, self._turned) @ SE2(north, east, 0.0)
        self.fix[:] = self._fixes.oldest
        self.fix[:3] += (drift.x, drift.y, down)

    def _draw(self, periods: int) -> Float[np.ndarray, "n 24"]:
        """Draws the noise of many periods."""
        driven = self._drive * self._rng.standard_normal((periods, _DRIFTS))
        white = self._white * self._rng.standard_normal((periods, _WHITE_NOISES))
        return np.hstack([driven, white])
