"""What the sensors read: inertial unit, GPS with an antenna on the boom, magnetometer and altimeter.

Every reading is the truth with white noise and, where stated, an error that wanders (Gauss-Markov: standard
deviation and correlation time). The inertial unit gives the mean over a control period.
"""

from functools import cache
from math import exp
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
from .sensor_errors import SensorErrors

_MOTION, _DRIFTS, _WHITE_NOISES = len(Motion._fields), 10, 14
# What is remembered of the motion before: velocity and attitude.
_BEFORE = 7
_NOISE, _STATE = _DRIFTS + _WHITE_NOISES, _BEFORE + _DRIFTS


Values = Float[np.ndarray, "n"]


class SensorReadings(Protocol):
    """What a filter reads: arrays that change, as `Sensors` has them."""

    inertial: Values
    fix: Values
    heading_and_height: Values
    has_fix: bool
    has_heading_and_height: bool

    @property
    def biases(self) -> Values:
        """Errors of accelerometers and gyros that wander."""

    def run(self) -> None:
        """Reads at the end of a control period."""

    def move_world(self, displacement: SE2) -> None:
        """Follows a motion of the whole world."""


@cache
def sensor_function(errors: SensorErrors, step: float, gravity: float) -> ca.Function:
    """Builds what the sensors make of a motion, without latency.

    Returns:
        (motion now, noise, state) -> (inertial reading, antenna position and velocity, heading and height,
        state). The noise is what drives the wandering errors and what is white, in the units of what it
        spoils but for the height; the state is velocity (world) and attitude quaternion of the period before,
        and the wandering errors.
    """
    now, noise, state = ca.SX.sym("now", _MOTION), ca.SX.sym("noise", _NOISE), ca.SX.sym("state", _STATE)
    velocity_before, first, drifts = ca.vertsplit(state, (0, 3, _BEFORE, _BEFORE + _DRIFTS))
    keep = ca.DM([exp(-step / drift.time) for drift in errors.drifts])
    drifts, white = keep * drifts + noise[:_DRIFTS], noise[_DRIFTS:]
    velocity, last = world_velocity(now), euler_quaternion(now[6:9])
    change = product(conjugate(first), last)
    rates = 2.0 * ca.sign(change[0]) * change[1:] / step
    middle = rotation(product(first, rotation_vector(rates * step / 2.0)))
    acceleration = (velocity - velocity_before) / step
    force = middle.T @ (acceleration - ca.DM([0, 0, gravity]))
    turn, arm = rotation(last), ca.DM(errors.antenna)
    antenna = ca.vertcat(now[:3] + turn @ arm, velocity + turn @ ca.cross(now[9:12], arm))
    heading, height = now[8] + (drifts[9] + white[12]), -now[2]
    results = [
        ca.vertcat(force, rates) + drifts[:6] + white[:6],
        antenna + white[6:12],
        ca.vertcat(heading, height + errors.height_sigma(height) * white[13]),
        ca.vertcat(velocity, last, drifts),
    ]
    return ca.Function("sense", [now, noise, state], ca.cse(results))


class Sensors:
    """Reads a vehicle's motion, period by period.

    Args:
        errors: their sizes.
        step: control period in s.
        gravity: m/s2.
        rng: source of all their chance.
        signals: where they find the true motion, that of the start already now.
        backend: what evaluates the readings.

    Attributes:
        inertial: specific force (m/s2) and body rates (rad/s), mean over the period that ends.
        fix: antenna position (m) and velocity (m/s) in the world, as they were a latency ago.
        heading_and_height: rad, not wrapped, and m above ground.
        has_fix: whether there is a fix in this period.
        has_heading_and_height: likewise.
    """

    def __init__(
        self,
        errors: SensorErrors,
        *,
        step: float,
        gravity: float,
        rng: np.random.Generator,
        signals: Signals,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        self._errors, self._rng, self._truth = errors, rng, signals.truth
        sigma = np.array([drift.sigma for drift in errors.drifts])
        keep = np.array([exp(-step / drift.time) for drift in errors.drifts])
        self._drive = sigma * np.sqrt(1.0 - keep**2)
        self._white = np.array([*errors.inertial_noise, *errors.fix_noise, errors.heading_noise, 1.0])
        self._state = np.concatenate([np.zeros(_BEFORE), sigma * rng.standard_normal(_DRIFTS)])
        self._drift = self._state[_BEFORE:]
        self._remember()
        self.inertial, self.fix, self.heading_and_height = np.zeros(6), np.zeros(6), np.zeros(2)
        self.has_fix = self.has_heading_and_height = False
        antenna, noise = np.zeros(6), np.zeros(_NOISE)
        self._sense = Recursion(
            sensor_function(errors, step, gravity),
            (signals.truth, noise, self._state),
            (self.inertial, antenna, self.heading_and_height),
            backend=backend,
        )
        self._noise = Noise(noise, self._draw)
        self._fixes = DelayLine((antenna,), periods=errors.fix_latency)
        self._turned = 0.0
        self._period = 0

    @property
    def biases(self) -> np.ndarray:
        """Errors of accelerometers and gyros that wander, as they are: what a filter looks for."""
        return np.asarray(self._drift[:6])

    def move_world(self, displacement: SE2) -> None:
        """Follows a motion of the whole world, after which the truth is that of the signals."""
        self._remember()
        self._turned += displacement.heading
        for fix in self._fixes.rows:
            pose = displacement @ SE2(fix[0], fix[1], 0.0)
            velocity = SE2(0.0, 0.0, displacement.heading) @ SE2(fix[3], fix[4], 0.0)
            fix[:2], fix[3:5] = (pose.x, pose.y), (velocity.x, velocity.y)

    def _remember(self) -> None:
        """Takes the truth as what was so a period ago."""
        nominal = initial_nominal_function()(self._truth)
        self._state[:_BEFORE] = nominal.elements()[3:10]

    def run(self) -> None:
        """Reads at the end of a control period."""
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
        """Takes the oldest fix, with the error that wanders."""
        north, east, down = self._drift[6:9].tolist()
        drift = SE2(0.0, 0.0, self._turned) @ SE2(north, east, 0.0)
        self.fix[:] = self._fixes.oldest
        self.fix[:3] += (drift.x, drift.y, down)

    def _draw(self, periods: int) -> Float[np.ndarray, "n 24"]:
        """Draws what spoils the readings of many periods."""
        driven = self._drive * self._rng.standard_normal((periods, _DRIFTS))
        white = self._white * self._rng.standard_normal((periods, _WHITE_NOISES))
        return np.hstack([driven, white])
