"""The navigation filter's equations as CasADi expressions: strapdown mechanisation and covariance.

Error-state Kalman filter. The nominal state is position, velocity (world), attitude quaternion (body to
world), biases of accelerometers and gyros. Its error has 15 entries, position, velocity, rotation in body
axes, the two biases, and 4 that are considered but never corrected (Schmidt): the wandering errors of fixes
and heading.
"""

from math import exp
from typing import Protocol

import casadi as ca

NOMINAL, ESTIMATED, CONSIDERED = 16, 15, 4
# Of what is believed: position, velocity in the heading frame, roll, pitch, heading.
SPREAD = 9
ERRORS = ESTIMATED + CONSIDERED
# An innovation of more than this many standard deviations is not believed.
GATE = 5.0


class _Wander(Protocol):
    @property
    def sigma(self) -> float: ...
    @property
    def time(self) -> float: ...


def ideal_readings(step: float, gravity: float, antenna: tuple[float, float, float]) -> ca.Function:
    """Returns (motion before, motion now) -> specific force, body rates, antenna position and velocity."""
    before, now = ca.SX.sym("before", 13), ca.SX.sym("now", 13)
    first, last = euler_quaternion(before[6:9]), euler_quaternion(now[6:9])
    change = product(conjugate(first), last)
    rates = 2.0 * ca.sign(change[0]) * change[1:] / step
    middle = rotation(product(first, rotation_vector(rates * step / 2.0)))
    acceleration = (world_velocity(now) - world_velocity(before)) / step
    force = middle.T @ (acceleration - ca.DM([0, 0, gravity]))
    turn, arm = rotation(last), ca.DM(antenna)
    place = now[:3] + turn @ arm
    velocity = world_velocity(now) + turn @ ca.cross(now[9:12], arm)
    return ca.Function("ideal", [before, now], [ca.vertcat(force, rates, place, velocity)])


def predict(step: float, gravity: float, noise: ca.DM, wanders: tuple[_Wander, ...]) -> ca.Function:
    """Returns (nominal, covariance, inertial reading) -> (nominal, covariance) one period later.

    Args:
        step: s.
        gravity: m/s2.
        noise: variances of accelerometers and gyros over a period, shape (6, 1).
        wanders: of the biases (6) and of the considered errors (4).
    """
    nominal, covariance = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("covariance", ERRORS, ERRORS)
    reading = ca.SX.sym("reading", 6)
    force, rates = reading[:3] - nominal[10:13], reading[3:] - nominal[13:16]
    quaternion = nominal[6:10]
    middle = rotation(product(quaternion, rotation_vector(rates * step / 2.0)))
    acceleration = middle @ force + ca.DM([0, 0, gravity])
    velocity = nominal[3:6] + step * acceleration
    turned = product(quaternion, rotation_vector(rates * step))
    keep = [exp(-step / wander.time) for wander in wanders]
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
    for place, (wander, kept) in enumerate(zip(wanders, keep, strict=True), start=9):
        transition[place, place] = kept
        added[place, place] = wander.sigma**2 * (1.0 - kept**2)
    for place in range(3):
        added[place, place] = 0.0
        added[3 + place, 3 + place] = step**2 * noise[place]
        added[6 + place, 6 + place] = step**2 * noise[3 + place]
    spread = _symmetric(transition @ _symmetric(covariance) @ transition.T + added)
    return ca.Function("predict", [nominal, covariance, reading], [after, spread])


def correct_fix(antenna: tuple[float, float, float], age: float, variances: tuple[float, ...]) -> ca.Function:
    """Returns (nominal, covariance, past, past rates, fix, specific force) -> (nominal, covariance).

    The fix is `age` seconds old. It is compared with the antenna of the nominal state of then, `past`; what
    the error of now says of the error of then enters the slopes.
    """
    nominal, covariance = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("covariance", ERRORS, ERRORS)
    past, rates, fix = ca.SX.sym("past", NOMINAL), ca.SX.sym("rates", 3), ca.SX.sym("fix", 6)
    force = ca.SX.sym("force", 3)
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
    error, after = ca.SX.zeros(ERRORS), _symmetric(covariance)
    for row in range(6):
        error, after = _correct(error, after, slopes[row, :], innovation[row], variances[row])
    return ca.Function(
        "correct_fix",
        [nominal, covariance, past, rates, fix, force],
        [inject(nominal, error), after],
    )


def correct_slow(heading_variance: float) -> ca.Function:
    """Returns (nominal, covariance, heading innovation, height, its variance) -> (nominal, covariance)."""
    nominal, covariance = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("covariance", ERRORS, ERRORS)
    innovation, height, variance = ca.SX.sym("innovation"), ca.SX.sym("height"), ca.SX.sym("variance")
    turn = rotation(nominal[6:10])
    # The heading's rate over a body rotation: (sin(roll) e_y + cos(roll) e_z) / cos(pitch).
    level = turn[2, 1] ** 2 + turn[2, 2] ** 2
    slopes = ca.SX(1, ERRORS)
    slopes[0, 7], slopes[0, 8] = turn[2, 1] / level, turn[2, 2] / level
    slopes[0, ERRORS - 1] = 1.0
    error, covariance_after = _correct(
        ca.SX.zeros(ERRORS), _symmetric(covariance), slopes, innovation, heading_variance
    )
    slopes = ca.SX(1, ERRORS)
    slopes[0, 2] = -1.0
    error, covariance_after = _correct(error, covariance_after, slopes, height + nominal[2], variance)
    return ca.Function(
        "correct_slow",
        [nominal, covariance, innovation, height, variance],
        [inject(nominal, error), covariance_after],
    )


def _correct(
    error: ca.SX, covariance: ca.SX, slopes: ca.SX, innovation: ca.SX, variance: ca.SX | float
) -> tuple[ca.SX, ca.SX]:
    """Takes one number in: Schmidt's gain in Joseph's form, nothing where the innovation is past the gate."""
    reach = covariance @ slopes.T
    spread = slopes @ reach + variance
    left = innovation - slopes @ error
    gain = reach / spread
    gain[ESTIMATED:] = 0.0
    gain = ca.if_else(left**2 <= GATE**2 * spread, gain, ca.SX.zeros(ERRORS))
    crossed = gain @ reach.T
    smaller = covariance - crossed - crossed.T + spread * (gain @ gain.T)
    return error + gain * left, _symmetric(smaller)


def _symmetric(matrix: ca.SX) -> ca.SX:
    """Returns a symmetric matrix from its upper half, so that the other half costs nothing."""
    return ca.densify(ca.triu2symm(ca.triu(matrix)))


def believe() -> ca.Function:
    """Returns (nominal, inertial reading) -> motion laid out as `Motion`, the heading wrapped."""
    nominal, reading = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("reading", 6)
    turn, velocity, rates = rotation(nominal[6:10]), nominal[3:6], reading[3:] - nominal[13:16]
    roll, heading = ca.atan2(turn[2, 1], turn[2, 2]), ca.atan2(turn[1, 0], turn[0, 0])
    pitch = ca.asin(ca.fmax(-1.0, ca.fmin(1.0, -turn[2, 0])))
    c, s = ca.cos(heading), ca.sin(heading)
    level = ca.vertcat(c * velocity[0] + s * velocity[1], -s * velocity[0] + c * velocity[1], velocity[2])
    yaw_rate = (rates[1] * ca.sin(roll) + rates[2] * ca.cos(roll)) / ca.cos(pitch)
    motion = ca.vertcat(nominal[:3], level, roll, pitch, heading, rates, yaw_rate)
    return ca.Function("believe", [nominal, reading], [motion])


def spread() -> ca.Function:
    """Returns (nominal, covariance) -> one standard deviation of what `believe` says: its first nine entries.

    First order: the slopes of what is believed over the error, around no error.
    """
    nominal, covariance = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("covariance", ERRORS, ERRORS)
    error = ca.SX.sym("error", ESTIMATED)
    believed = believe()(inject(nominal, error), ca.SX.zeros(6))[:SPREAD]
    slopes = ca.substitute(ca.jacobian(believed, error), error, 0)
    estimated = _symmetric(covariance)[:ESTIMATED, :ESTIMATED]
    sigmas = ca.sqrt(ca.sum2((slopes @ estimated) * slopes))
    return ca.Function("spread", [nominal, covariance], [ca.densify(sigmas)])


def first_nominal() -> ca.Function:
    """Returns motion -> nominal state without biases."""
    motion = ca.SX.sym("motion", 13)
    nominal = ca.vertcat(motion[:3], world_velocity(motion), euler_quaternion(motion[6:9]), ca.DM.zeros(6))
    return ca.Function("first_nominal", [motion], [nominal])


def injection() -> ca.Function:
    """Returns (nominal, error) -> nominal."""
    nominal, error = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("error", ESTIMATED)
    return ca.Function("injection", [nominal, error], [inject(nominal, error)])


def difference() -> ca.Function:
    """Returns (nominal, motion) -> error of position, velocity and attitude, shape (9, 1)."""
    nominal, motion = ca.SX.sym("nominal", NOMINAL), ca.SX.sym("motion", 13)
    left = product(conjugate(nominal[6:10]), euler_quaternion(motion[6:9]))
    turned = 2.0 * ca.sign(left[0]) * left[1:]
    error = ca.vertcat(motion[:3] - nominal[:3], world_velocity(motion) - nominal[3:6], turned)
    return ca.Function("difference", [nominal, motion], [error])


def inject(nominal: ca.SX, error: ca.SX) -> ca.SX:
    """Returns the nominal state with an error taken up."""
    turned = product(nominal[6:10], rotation_vector(error[6:9]))
    return ca.vertcat(nominal[:6] + error[:6], turned / ca.norm_2(turned), nominal[10:] + error[9:15])


def world_velocity(motion: ca.SX) -> ca.SX:
    """Returns the velocity in the world of a motion laid out as `Motion`."""
    c, s = ca.cos(motion[8]), ca.sin(motion[8])
    return ca.vertcat(c * motion[3] - s * motion[4], s * motion[3] + c * motion[4], motion[5])


def euler_quaternion(angles: ca.SX) -> ca.SX:
    """Returns the quaternion, body to world, of roll, pitch and heading."""
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
    """Returns the opposite rotation."""
    return ca.vertcat(quaternion[0], -quaternion[1:])


def product(a: ca.SX, b: ca.SX) -> ca.SX:
    """Returns the quaternion that rotates by b first, then by a."""
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
