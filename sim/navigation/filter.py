"""Equations of the navigation filter: strapdown mechanisation and covariance.

Error-state Kalman filter in CasADi. The nominal state is position, velocity (world), attitude quaternion
(body to world), biases of accelerometers and gyros. Its error has 15 estimated entries, position, velocity,
rotation in body axes, the two biases, and 4 considered ones (Schmidt): the Gauss-Markov errors of fixes and
heading.
"""

from collections.abc import Callable
from math import exp, pi

import casadi as ca

from .sensor_errors import GaussMarkovError

NOMINAL, ESTIMATED, CONSIDERED = 16, 15, 4
# Position, velocity in the heading frame, roll, pitch, heading.
OUTPUTS = 9
ERRORS = ESTIMATED + CONSIDERED
_UPPER = ca.Sparsity.upper(ERRORS)
STATE = NOMINAL + _UPPER.nnz() + 1
"""Size of the filter's state: nominal state, upper half of the covariance by columns, heading in rad."""
# Innovations above this many standard deviations are rejected.
GATE = 5.0


def prediction_function(
    step: float, gravity: float, noise: tuple[float, ...], drifts: tuple[GaussMarkovError, ...]
) -> ca.Function:
    """Returns (inertial reading, state) -> (motion, state) one period later.

    Args:
        step: period, s.
        gravity: gravity, m/s2.
        noise: standard deviations of accelerometers and gyros over a period.
        drifts: Gauss-Markov errors: biases (6) and considered errors (4).
    """
    state, reading = ca.SX.sym("state", STATE), ca.SX.sym("reading", 6)
    nominal, covariance, heading = split_filter_state(state)
    force, rates = reading[:3] - nominal[10:13], reading[3:] - nominal[13:16]
    quaternion = nominal[6:10]
    middle = rotation(product(quaternion, rotation_vector(rates * step / 2.0)))
    acceleration = middle @ force + ca.DM([0, 0, gravity])
    velocity = nominal[3:6] + step * acceleration
    turned = product(quaternion, rotation_vector(rates * step))
    keep = [exp(-step / drift.time) for drift in drifts]
    after = ca.vertcat(
        nominal[:3] + step * (nominal[3:6] + velocity) / 2.0,
        velocity,
        turned / ca.norm_2(turned),
        ca.DM(keep[:6]) * nominal[10:16],
    )
    transition = ca.SX(ca.Sparsity.diag(ERRORS))
    transition[:9, :9] = ca.SX.eye(9)
    transition[:3, 3:6] = step * ca.SX.eye(3)
    transition[3:6, 6:9] = -step * middle @ ca.skew(force)
    transition[3:6, 9:12] = -step * middle
    transition[6:9, 6:9] = rotation(rotation_vector(rates * step)).T
    transition[6:9, 12:15] = -step * ca.SX.eye(3)
    added = ca.SX(ca.Sparsity.diag(ERRORS))
    for place, (drift, kept) in enumerate(zip(drifts, keep, strict=True), start=9):
        transition[place, place] = kept
        added[place, place] = drift.sigma**2 * (1.0 - kept**2)
    for place in range(3):
        added[place, place] = 0.0
        added[3 + place, 3 + place] = step**2 * noise[place] ** 2
        added[6 + place, 6 + place] = step**2 * noise[3 + place] ** 2
    predicted = transition @ covariance @ transition.T + added
    results = _estimate_and_state(after, predicted, heading, reading)
    return ca.Function("predict", [reading, state], ca.cse(results))


def fix_correction_function(
    antenna: tuple[float, float, float], age: float, sigmas: tuple[float, ...]
) -> ca.Function:
    """Returns (past, fix, inertial reading, state) -> (motion, tests, state).

    Tests are the innovations in standard deviations, processed in sequence, rejected ones included. The fix
    is `age` seconds old and is compared with the antenna position of the nominal state and inertial reading
    of that time, `past`; the slopes relate the present error to the error of that time.

    Args:
        antenna: position of the antenna from the centre of mass, forward, right, down, m.
        age: age of the fix, s.
        sigmas: standard deviations of the fix's noise.
    """
    state, reading = ca.SX.sym("state", STATE), ca.SX.sym("reading", 6)
    past, fix = ca.SX.sym("past", NOMINAL + 6), ca.SX.sym("fix", 6)
    nominal, covariance, heading = split_filter_state(state)
    force, rates = reading[:3] - nominal[10:13], past[NOMINAL + 3 :] - past[13:16]
    arm, turn = ca.DM(antenna), rotation(past[6:10])
    swing = ca.cross(rates, arm)
    innovation = fix - ca.vertcat(past[:3] + turn @ arm, past[3:6] + turn @ swing)
    slopes = ca.SX(6, ERRORS)
    leaning = turn @ ca.skew(force)
    slopes[:3, :3] = ca.SX.eye(3)
    slopes[:3, 3:6] = -age * ca.SX.eye(3)
    slopes[:3, 6:9] = -turn @ ca.skew(arm) - age**2 / 2.0 * leaning
    slopes[:3, ESTIMATED : ESTIMATED + 3] = ca.SX.eye(3)
    slopes[3:, 3:6] = ca.SX.eye(3)
    slopes[3:, 6:9] = -turn @ ca.skew(swing) + age * leaning
    slopes[3:, 9:12] = age * turn
    error, tests = ca.SX.zeros(ESTIMATED), []
    for row in range(6):
        error, covariance, test = _correct(
            error, covariance, slopes[row, :], innovation[row], sigmas[row] ** 2
        )
        tests.append(test)
    motion, after = _estimate_and_state(inject(nominal, error), covariance, heading, reading)
    results = [motion, ca.vertcat(*tests), after]
    return ca.Function("correct_fix", [past, fix, reading, state], ca.cse(results))


def heading_height_correction_function(
    heading_sigma: float, height_sigma: Callable[[ca.SX], ca.SX]
) -> ca.Function:
    """Returns (heading and height, inertial, state) -> (motion, tests, state).

    See `fix_correction_function` for the tests.

    Args:
        heading_sigma: standard deviation of the heading's noise, rad.
        height_sigma: standard deviation of the altimeter's noise at a height, m.
    """
    state, reading, seen = ca.SX.sym("state", STATE), ca.SX.sym("reading", 6), ca.SX.sym("seen", 2)
    nominal, covariance, heading = split_filter_state(state)
    turn = rotation(nominal[6:10])
    # The heading's rate over a body rotation: (sin(roll) e_y + cos(roll) e_z) / cos(pitch).
    level = turn[2, 1] ** 2 + turn[2, 2] ** 2
    slopes = ca.SX(1, ERRORS)
    slopes[0, 7], slopes[0, 8] = turn[2, 1] / level, turn[2, 2] / level
    slopes[0, ERRORS - 1] = 1.0
    innovation = ca.remainder(seen[0] - ca.atan2(turn[1, 0], turn[0, 0]), 2.0 * pi)
    error, covariance, first = _correct(
        ca.SX.zeros(ESTIMATED), covariance, slopes, innovation, heading_sigma**2
    )
    slopes = ca.SX(1, ERRORS)
    slopes[0, 2] = -1.0
    error, covariance, second = _correct(
        error, covariance, slopes, seen[1] + nominal[2], height_sigma(seen[1]) ** 2
    )
    motion, after = _estimate_and_state(inject(nominal, error), covariance, heading, reading)
    results = [motion, ca.vertcat(first, second), after]
    return ca.Function("correct_slow", [seen, reading, state], ca.cse(results))


def _correct(
    error: ca.SX, covariance: ca.SX, slopes: ca.SX, innovation: ca.SX, variance: ca.SX | float
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Processes one scalar innovation with Schmidt's gain and a gate.

    Innovations beyond the gate change nothing. Returns error, covariance, and the innovation in standard
    deviations. For the estimated errors and their covariance with the considered ones Joseph's form reduces
    to a difference; the covariance of the considered errors is unchanged.
    """
    reach = covariance @ slopes.T
    innovation_variance = slopes @ reach + variance
    left = innovation - slopes[:ESTIMATED] @ error
    # Also false for not-a-number, the innovation of a sensor without reading.
    accepted = left**2 <= GATE**2 * innovation_variance
    gain = ca.if_else(accepted, reach[:ESTIMATED] / innovation_variance, ca.SX.zeros(ESTIMATED))
    smaller = covariance
    smaller[:ESTIMATED, :] -= gain @ reach.T
    return (
        error + gain * ca.if_else(accepted, left, 0.0),
        _symmetric(smaller),
        left / ca.sqrt(innovation_variance),
    )


def split_filter_state(state: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Returns nominal state, covariance and heading of a filter's state."""
    nominal, upper, heading = ca.vertsplit(state, (0, NOMINAL, NOMINAL + _UPPER.nnz(), STATE))
    return nominal, ca.triu2symm(ca.SX(_UPPER, upper)), heading


def _symmetric(matrix: ca.SX) -> ca.SX:
    """Returns a symmetric matrix from its upper half.

    The lower half is never evaluated.
    """
    return ca.triu2symm(ca.triu(ca.densify(matrix)))


def estimated_motion(nominal: ca.SX, rates: ca.SX, before: ca.SX) -> ca.SX:
    """Returns the motion of a nominal state, laid out as `Motion`.

    Args:
        nominal: nominal state.
        rates: body rates, rad/s.
        before: previous heading, for unwrapping, rad.
    """
    turn, velocity = rotation(nominal[6:10]), nominal[3:6]
    roll, heading = ca.atan2(turn[2, 1], turn[2, 2]), ca.atan2(turn[1, 0], turn[0, 0])
    pitch = ca.asin(ca.fmax(-1.0, ca.fmin(1.0, -turn[2, 0])))
    c, s = ca.cos(heading), ca.sin(heading)
    level = ca.vertcat(c * velocity[0] + s * velocity[1], -s * velocity[0] + c * velocity[1], velocity[2])
    yaw_rate = (rates[1] * ca.sin(roll) + rates[2] * ca.cos(roll)) / ca.cos(pitch)
    heading = before + ca.remainder(heading - before, 2.0 * pi)
    return ca.vertcat(nominal[:3], level, roll, pitch, heading, rates, yaw_rate)


def _estimate_and_state(nominal: ca.SX, covariance: ca.SX, before: ca.SX, reading: ca.SX) -> list[ca.SX]:
    """Returns the estimated motion and the filter's state."""
    motion = estimated_motion(nominal, reading[3:] - nominal[13:16], before)
    upper = ca.project(ca.densify(covariance), _UPPER).nz[:]
    return [motion, ca.vertcat(nominal, upper, motion[OUTPUTS - 1])]


def standard_deviation_function(misalignment: float) -> ca.Function:
    """Returns state -> standard deviations of the estimate.

    The first nine entries of the motion, to first order about zero error.

    Args:
        misalignment: standard deviation of the inertial unit's angles in the vehicle, rad.
    """
    state, error = ca.SX.sym("state", STATE), ca.SX.sym("error", ESTIMATED)
    nominal, covariance, heading = split_filter_state(state)
    motion = estimated_motion(inject(nominal, error), ca.SX.zeros(3), heading)[:OUTPUTS]
    slopes = ca.substitute(ca.jacobian(motion, error), error, ca.SX.zeros(ESTIMATED))
    estimated = covariance[:ESTIMATED, :ESTIMATED]
    estimated += ca.diag(ca.DM([*(0.0,) * 6, *(misalignment**2,) * 3, *(0.0,) * 6]))
    sigmas = ca.densify(ca.sqrt(ca.sum2((slopes @ estimated) * slopes)))
    return ca.Function("standard_deviation", [state], [ca.cse(sigmas)])


def initial_nominal_function() -> ca.Function:
    """Returns motion -> nominal state without biases."""
    motion = ca.SX.sym("motion", 13)
    nominal = ca.vertcat(motion[:3], world_velocity(motion), euler_quaternion(motion[6:9]), ca.DM.zeros(6))
    return ca.Function("first_nominal", [motion], [nominal])


def injection_function() -> ca.Function:
    """Returns (nominal, error) -> nominal."""
    nominal, error = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("error", ESTIMATED)
    return ca.Function("injection", [nominal, error], [inject(nominal, error)])


def error_function() -> ca.Function:
    """Returns (nominal, motion) -> error of position, velocity and attitude."""
    nominal, motion = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("motion", 13)
    left = product(conjugate(nominal[6:10]), euler_quaternion(motion[6:9]))
    turned = 2.0 * ca.sign(left[0]) * left[1:]
    error = ca.vertcat(motion[:3] - nominal[:3], world_velocity(motion) - nominal[3:6], turned)
    return ca.Function("difference", [nominal, motion], [error])


def inject(nominal: ca.SX, error: ca.SX) -> ca.SX:
    """Returns the nominal state corrected by an error."""
    turned = product(nominal[6:10], rotation_vector(error[6:9]))
    return ca.vertcat(nominal[:6] + error[:6], turned / ca.norm_2(turned), nominal[10:] + error[9:15])


def world_velocity(motion: ca.SX) -> ca.SX:
    """Returns the world velocity of a motion laid out as `Motion`."""
    c, s = ca.cos(motion[8]), ca.sin(motion[8])
    return ca.vertcat(c * motion[3] - s * motion[4], s * motion[3] + c * motion[4], motion[5])


def euler_quaternion(angles: ca.SX) -> ca.SX:
    """Returns the body-to-world quaternion of roll, pitch and heading."""
    (cr, cp, ch), (sr, sp, sh) = ca.vertsplit(ca.cos(angles / 2)), ca.vertsplit(ca.sin(angles / 2))
    return ca.vertcat(
        cr * cp * ch + sr * sp * sh,
        sr * cp * ch - cr * sp * sh,
        cr * sp * ch + sr * cp * sh,
        cr * cp * sh - sr * sp * ch,
    )


def rotation_vector(angles: ca.SX) -> ca.SX:
    """Returns the quaternion of a small rotation vector, to third order."""
    square = ca.dot(angles, angles)
    return ca.vertcat(1.0 - square / 8.0, angles * (0.5 - square / 48.0))


def conjugate(quaternion: ca.SX) -> ca.SX:
    """Returns the inverse rotation."""
    return ca.vertcat(quaternion[0], -quaternion[1:])


def product(a: ca.SX, b: ca.SX) -> ca.SX:
    """Returns the quaternion of rotation b followed by a."""
    return ca.vertcat(
        a[0] * b[0] - ca.dot(a[1:], b[1:]), a[0] * b[1:] + b[0] * a[1:] + ca.cross(a[1:], b[1:])
    )


def rotation(quaternion: ca.SX) -> ca.SX:
    """Returns the rotation matrix of a unit quaternion."""
    w, x, y, z = ca.vertsplit(quaternion)
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
