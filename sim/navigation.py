"""What the vehicle believes: an error-state Kalman filter on the readings of its sensors.

The equations are those of `filter_equations`; here they are bound to arrays and fed, period by period.
"""

from collections import deque
from math import cos, pi, radians, remainder, sin

import casadi as ca
import numpy as np
from jaxtyping import Float

from flight.se2 import SE2

from . import filter_equations as equations
from .bound_function import BoundFunction
from .filter_equations import ERRORS, ESTIMATED, NOMINAL, SPREAD
from .motion import Motion
from .sensors import Readings, SensorErrors, Sensors

# What the filter knows at its start, one sigma: position (m), velocity (m/s), roll, pitch, heading (rad).
_FIRST = (0.1,) * 3 + (0.05,) * 3 + (radians(0.5), radians(0.5), radians(2.0))
# Entries of the error that are vectors of the world, by the place of their north.
_WORLD_VECTORS = (0, 3, ESTIMATED)


class IdealNavigation:
    """Believes what is so, at once."""

    def step(self, truth: Motion) -> Motion:
        """Returns the truth."""
        return truth

    def spread(self) -> None:
        """Knows of no error."""
        return

    def move(self, displacement: SE2, truth: Motion) -> None:
        """Follows a motion of the whole world."""


class Navigation:
    """Sensors and filter: it turns true motion into an estimate, period by period.

    Args:
        truth: motion at the start.
        step: control period in s.
        gravity: m/s2.
        rng: source of all its chance.
        errors: sizes of the sensors' errors, which the filter knows.
    """

    def __init__(
        self,
        truth: Motion,
        *,
        step: float,
        gravity: float,
        rng: np.random.Generator,
        errors: SensorErrors | None = None,
    ) -> None:
        errors = errors or SensorErrors()
        self._errors, self._step = errors, step
        self.gps_lost = False
        """Set to silence the GPS."""
        self._sensors = Sensors(errors, truth, step=step, gravity=gravity, rng=rng)
        self._nominals = (np.zeros(NOMINAL), np.zeros(NOMINAL))
        self._covariances = (np.zeros((ERRORS, ERRORS)), np.zeros((ERRORS, ERRORS)))
        self._current = 0
        self._inertial, self._believed = np.zeros(6), np.zeros(13)
        self._past, self._rates, self._fix, self._force = (
            np.zeros(NOMINAL),
            np.zeros(3),
            np.zeros(6),
            np.zeros(3),
        )
        self._innovation, self._height, self._variance = np.zeros(1), np.zeros(1), np.zeros(1)
        self._bind(gravity)
        self._history: deque[tuple[np.ndarray, np.ndarray]] = deque(maxlen=errors.fix_latency + 1)
        self._heading = truth.heading
        self._begin(truth, rng)

    def _bind(self, gravity: float) -> None:
        errors = self._errors
        wanders = (
            *(errors.accelerometer_bias,) * 3,
            *(errors.gyro_bias,) * 3,
            *(errors.position_wander,) * 3,
            errors.heading_wander,
        )
        noise = ca.DM([errors.accelerometer_noise**2] * 3 + [errors.gyro_noise**2] * 3)
        fixes = tuple(sigma**2 for sigma in (*errors.position_noise, *(errors.velocity_noise,) * 3))
        age = errors.fix_latency * self._step
        self._predict = self._both(equations.predict(self._step, gravity, noise, wanders), self._inertial)
        self._correct_fix = self._both(
            equations.correct_fix(errors.antenna, age, fixes),
            *(self._past, self._rates, self._fix, self._force),
        )
        self._correct_slow = self._both(
            equations.correct_slow(errors.heading_noise**2), self._innovation, self._height, self._variance
        )
        self._believe = tuple(
            BoundFunction(equations.believe(), (nominal, self._inertial), (self._believed,))
            for nominal in self._nominals
        )
        self._sigmas = np.zeros(SPREAD)
        self._measure_spread = tuple(
            BoundFunction(equations.spread(), (nominal, covariance), (self._sigmas,))
            for nominal, covariance in zip(self._nominals, self._covariances, strict=True)
        )

    def _both(self, function: ca.Function, *inputs: np.ndarray) -> tuple[BoundFunction, ...]:
        """Binds a function from either state to the other, because input and output must not be one array."""
        nominals, covariances = self._nominals, self._covariances
        return tuple(
            BoundFunction(
                function,
                (nominals[source], covariances[source], *inputs),
                (nominals[1 - source], covariances[1 - source]),
            )
            for source in (0, 1)
        )

    def _begin(self, truth: Motion, rng: np.random.Generator) -> None:
        errors = self._errors
        biases = (errors.accelerometer_bias.sigma,) * 3 + (errors.gyro_bias.sigma,) * 3
        considered = (errors.position_wander.sigma,) * 3 + (errors.heading_wander.sigma,)
        self._covariances[0][:] = np.diag(np.square([*_FIRST, *biases, *considered]))
        exact = np.array(equations.first_nominal()(ca.DM(list(truth)))).ravel()
        error = np.concatenate([np.array(_FIRST) * rng.standard_normal(9), np.zeros(6)])
        self._nominals[0][:] = np.array(equations.injection()(exact, error)).ravel()

    def step(self, truth: Motion) -> Motion:
        """Returns what is believed now."""
        readings = self._sensors.read(truth)
        self._inertial[:] = readings.inertial
        self._advance(self._predict)
        nominal = self._nominals[self._current]
        self._history.append((nominal.copy(), self._inertial[3:] - nominal[13:]))
        self._correct(readings)
        self._believe[self._current].evaluate()
        values = self._believed.tolist()
        self._heading += remainder(values[8] - self._heading, 2.0 * pi)
        values[8] = self._heading
        return Motion._make(values)

    def spread(self) -> tuple[float, ...]:
        """Returns a standard deviation for each field of `/navigation`, as the filter claims now."""
        self._measure_spread[self._current].evaluate()
        return tuple(self._sigmas.tolist())

    def _correct(self, readings: Readings) -> None:
        if readings.fix is not None and not self.gps_lost:
            self._past[:], self._rates[:] = self._history[0]
            self._fix[:] = readings.fix
            self._force[:] = self._inertial[:3] - self._nominals[self._current][10:13]
            self._advance(self._correct_fix)
        if readings.heading is not None and readings.height is not None:
            self._believe[self._current].evaluate()
            self._innovation[0] = remainder(readings.heading - float(self._believed[8]), 2.0 * pi)
            self._height[0] = readings.height
            self._variance[0] = self._errors.height_variance(readings.height)
            self._advance(self._correct_slow)

    def _advance(self, functions: tuple[BoundFunction, ...]) -> None:
        functions[self._current].evaluate()
        self._current = 1 - self._current

    def move(self, displacement: SE2, truth: Motion) -> None:
        """Follows a motion of the whole world, after which the truth is `truth`."""
        self._sensors.move(displacement, truth)
        turn = np.eye(ERRORS)
        c, s = cos(displacement.heading), sin(displacement.heading)
        for place in _WORLD_VECTORS:
            turn[place : place + 2, place : place + 2] = ((c, -s), (s, c))
        covariance = self._covariances[self._current]
        covariance[:] = turn @ covariance @ turn.T
        for nominal in (self._nominals[self._current], *(past for past, _ in self._history)):
            _move(nominal, displacement)
        self._heading += displacement.heading

    def error(self, truth: Motion) -> Float[np.ndarray, "15"]:
        """Returns the error of the estimate: position, velocity, rotation in body axes, biases."""
        nominal = self._nominals[self._current]
        difference = equations.difference()(nominal, ca.DM(list(truth)))
        return np.concatenate([np.array(difference).ravel(), self._sensors.biases - nominal[10:]])

    def normalised_error(self, truth: Motion) -> float:
        """Returns the squared error in units of the covariance that the filter claims."""
        error = self.error(truth)
        covariance = self._covariances[self._current][:ESTIMATED, :ESTIMATED]
        return float(error @ np.linalg.solve(covariance, error))


def _move(nominal: np.ndarray, displacement: SE2) -> None:
    """Moves position, velocity and attitude with the world."""
    pose = displacement @ SE2(nominal[0], nominal[1], 0.0)
    velocity = SE2(0.0, 0.0, displacement.heading) @ SE2(nominal[3], nominal[4], 0.0)
    nominal[:2], nominal[3:5] = (pose.x, pose.y), (velocity.x, velocity.y)
    c, s = cos(displacement.heading / 2.0), sin(displacement.heading / 2.0)
    w, x, y, z = nominal[6:10]
    nominal[6:10] = (c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w)
