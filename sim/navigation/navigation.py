"""Navigation: error-state Kalman filter on sensor readings.

The equations of `filter` are bound to arrays and evaluated period by period.
"""

from functools import cache
from math import cos, radians, sin
from typing import Protocol

import casadi as ca
import numpy as np
from jaxtyping import Float

from flight.se2 import SE2
from sim.loop.backend import Backend
from sim.loop.bound_function import BoundFunction, Recursion, memory_view
from sim.loop.delay_line import DelayLine
from sim.loop.motion import Motion
from sim.loop.signals import Signals

from . import filter as equations
from .filter import ERRORS, ESTIMATED, NOMINAL, OUTPUTS, STATE
from .installation import Installation
from .sensor_errors import SensorErrors, sensor_classes
from .sensors import SensorReadings, Sensors

# Initial standard deviations: position (m, or that of a fix), velocity (m/s), roll, pitch, heading (rad).
_FIRST = (0.1,) * 3 + (0.05,) * 3 + (radians(0.5), radians(0.5), radians(2.0))
# Entries of the error that are world vectors, by their first index.
_WORLD_VECTORS = (0, 3, ESTIMATED)


# Rows and columns of the covariance's upper half, column by column.
_COLUMNS, _ROWS = np.tril_indices(ERRORS)


class Navigator(Protocol):
    """Navigation: estimate from truth, period by period."""

    def run(self) -> None:
        """Updates the estimate at the end of a control period."""

    def standard_deviation(self) -> tuple[float, ...] | None:
        """Returns standard deviations of `/navigation`; None if unknown."""

    def move_world(self, displacement: SE2) -> None:
        """Applies a displacement of the world, with the signals' new truth."""


class IdealNavigation:
    """Ideal navigation: the estimate equals the truth.

    Args:
        signals: input truth, output estimate.
    """

    def __init__(self, signals: Signals) -> None:
        self._truth, self._estimate = memory_view(signals.truth), memory_view(signals.estimate)
        self.run()

    def run(self) -> None:
        """Copies the truth to the estimate."""
        self._estimate[:] = self._truth

    def standard_deviation(self) -> None:
        """Returns None: there are no errors."""
        return

    def move_world(self, displacement: SE2) -> None:
        """Applies a displacement of the whole world."""
        self.run()


class Navigation:
    """Sensors and filter: estimate from true motion, period by period.

    Args:
        truth: motion at the start.
        step: control period, s.
        gravity: gravity, m/s2.
        rng: random generator.
        errors: sensor errors assumed by the filter; those of the class `rtk` if None.
        true_errors: actual sensor errors; those assumed if None.
        installation: errors of the airframe's sensors; none if None.
        signals: input truth, output estimate; its own if None.
        backend: numeric back-end.

    Attributes:
        fix_tests: innovations of the last fix in standard deviations: position and velocity, world axes.
        slow_tests: innovations of heading and height in standard deviations.
    """

    def __init__(
        self,
        truth: Motion,
        *,
        step: float,
        gravity: float,
        rng: np.random.Generator,
        errors: SensorErrors | None = None,
        true_errors: SensorErrors | None = None,
        installation: Installation | None = None,
        signals: Signals | None = None,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        self._assumed = errors = errors or sensor_classes()["rtk"]
        self.signals = signals = signals or Signals()
        signals.truth[:] = signals.estimate[:] = truth
        sensors = Sensors(
            true_errors or errors,
            step=step,
            gravity=gravity,
            rng=rng,
            installation=installation,
            signals=signals,
            backend=backend,
        )
        self.sensors: SensorReadings = sensors
        """Sensors of the filter; a wrapper with the same arrays may replace them."""
        self._state = np.zeros(STATE)
        self._initialise(truth, errors, rng)
        self._history = DelayLine((self._state[:NOMINAL], sensors.inertial), periods=errors.fix_latency)
        self._past = np.zeros(NOMINAL + 6)
        *functions, measure = _functions(errors, step, gravity)
        self.fix_tests, self.slow_tests = np.zeros(6), np.zeros(2)
        self._predict, self._correct_fix, self._correct_slow = (
            Recursion(
                function,
                (*seen, sensors.inertial, self._state),
                (signals.estimate, *tests),
                backend=backend,
            )
            for function, seen, tests in zip(
                functions,
                ((), (self._past, sensors.fix), (sensors.heading_and_height,)),
                ((), (self.fix_tests,), (self.slow_tests,)),
                strict=True,
            )
        )
        self._sigmas = np.zeros(OUTPUTS)
        self._measure_sigmas = BoundFunction(measure, (self._state,), (self._sigmas,), backend=backend)

    def _initialise(self, truth: Motion, errors: SensorErrors, rng: np.random.Generator) -> None:
        """Draws the initial estimate."""
        first = np.array([*(max(_FIRST[0], errors.position_sigma),) * 3, *_FIRST[3:]])
        sigmas = np.array([*first, *(drift.sigma for drift in errors.believed_drifts)])
        exact = np.array(equations.initial_nominal_function()(ca.DM(list(truth)))).ravel()
        error = np.concatenate([first * rng.standard_normal(9), np.zeros(6)])
        self._state[:NOMINAL] = np.array(equations.injection_function()(exact, error)).ravel()
        self._covariance = np.diag(sigmas**2)
        self._state[-1] = truth.heading

    @property
    def _covariance(self) -> Float[np.ndarray, "19 19"]:
        upper = np.zeros((ERRORS, ERRORS))
        upper[_ROWS, _COLUMNS] = self._state[NOMINAL:-1]
        return np.asarray(upper + np.triu(upper, 1).T)

    @_covariance.setter
    def _covariance(self, covariance: Float[np.ndarray, "19 19"]) -> None:
        self._state[NOMINAL:-1] = covariance[_ROWS, _COLUMNS]

    def run(self) -> None:
        """Updates sensors and estimate at the end of a control period."""
        sensors = self.sensors
        sensors.run()
        self._predict.step()
        self._history.push()
        if sensors.has_fix:
            self._past[:] = self._history.oldest
            self._correct_fix.step()
        if sensors.has_heading_and_height:
            self._correct_slow.step()

    def standard_deviation(self) -> tuple[float, ...]:
        """Returns the filter's standard deviations for `/navigation`."""
        self._measure_sigmas.evaluate()
        return tuple(self._sigmas.tolist())

    def step(self, truth: Motion) -> Motion:
        """Returns the estimate after one period."""
        self.signals.truth[:] = truth
        self.run()
        return Motion._make(self.signals.estimate.tolist())

    def move_world(self, displacement: SE2) -> None:
        """Applies a displacement of the world, with the signals' new truth."""
        self.sensors.move_world(displacement)
        turn = np.eye(ERRORS)
        c, s = cos(displacement.heading), sin(displacement.heading)
        for place in _WORLD_VECTORS:
            turn[place : place + 2, place : place + 2] = ((c, -s), (s, c))
        self._covariance = turn @ self._covariance @ turn.T
        for nominal in (self._state, *self._history.rows):
            _move_nominal(nominal, displacement)
        self._state[-1] += displacement.heading
        estimate = self.signals.estimate
        moved = displacement @ Motion._make(estimate.tolist()).pose
        estimate[:2], estimate[8] = moved.position, moved.heading

    def error(self, truth: Motion) -> Float[np.ndarray, "15"]:
        """Returns the estimate's error in position, velocity, rotation and biases."""
        nominal = self._state[:NOMINAL]
        difference = equations.error_function()(nominal, ca.DM(list(truth)))
        return np.concatenate([np.array(difference).ravel(), self.sensors.biases - nominal[10:]])

    def normalised_error(self, truth: Motion) -> float:
        """Returns the normalised squared error (NEES)."""
        error, covariance = self.error(truth), self._claimed_covariance()
        return float(error @ np.linalg.solve(covariance, error))

    def normalised_position_error(self, truth: Motion) -> float:
        """Returns the normalised squared error of the position alone."""
        error, covariance = self.error(truth)[:3], self._claimed_covariance()[:3, :3]
        return float(error @ np.linalg.solve(covariance, error))

    def _claimed_covariance(self) -> Float[np.ndarray, "15 15"]:
        """Returns the covariance of the vehicle's motion, not of its inertial unit's."""
        covariance = self._covariance[:ESTIMATED, :ESTIMATED]
        covariance[range(6, 9), range(6, 9)] += self._assumed.misalignment**2
        return covariance


@cache
def _functions(errors: SensorErrors, step: float, gravity: float) -> tuple[ca.Function, ...]:
    """Builds prediction, corrections and standard deviations of a filter."""
    age = errors.fix_latency * step
    return (
        equations.prediction_function(step, gravity, errors.inertial_noise, errors.believed_drifts),
        equations.fix_correction_function(errors.antenna, age, errors.fix_noise),
        equations.heading_height_correction_function(errors.heading_noise, errors.height_sigma),
        equations.standard_deviation_function(errors.misalignment),
    )


def _move_nominal(nominal: np.ndarray, displacement: SE2) -> None:
    """Moves position, velocity and attitude with the world."""
    pose = displacement @ SE2(nominal[0], nominal[1], 0.0)
    velocity = SE2(0.0, 0.0, displacement.heading) @ SE2(nominal[3], nominal[4], 0.0)
    nominal[:2], nominal[3:5] = (pose.x, pose.y), (velocity.x, velocity.y)
    c, s = cos(displacement.heading / 2.0), sin(displacement.heading / 2.0)
    w, x, y, z = nominal[6:10]
    nominal[6:10] = (c * w - s * z, c * x - s * y, c * y + s * x, c * z + s * w)
