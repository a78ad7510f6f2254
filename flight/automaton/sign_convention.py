"""Sign convention of errors: gamma = +1 means fast and wide.

Signs come from the *nominal* trims and displacements, never from data, so that they cannot flip with a seed.
"""

from math import copysign

from flight.se2 import Twist

from .maneuver import ManeuverError


def signed_trim_error(size: Twist, velocity: Twist) -> Twist:
    """Returns a trim's error with the nominal value's sign, positive at 0.

    Args:
        size: absolute errors, metres per second and radians per second.
        velocity: the nominal body velocity.
    """
    return Twist(
        _with_sign_of(size.forward, velocity.forward),
        _with_sign_of(size.side, velocity.side),
        _with_sign_of(size.yaw_rate, velocity.yaw_rate),
    )


def signed_maneuver_error(size: ManeuverError, *, left: Twist, reached: Twist) -> ManeuverError:
    """Returns the error of a maneuver, signed.

    Durations have negative errors; forward displacement errors oppose the displacement, whose direction is
    that of the mean forward speed; with s = sign(r_from + r_to) the heading-change error has the sign s and
    the lateral error -s, both negative where s = 0.

    Args:
        size: absolute errors in seconds, metres and radians.
        left: nominal velocity of the trim that the maneuver leaves.
        reached: nominal velocity of the trim that the maneuver leads to.
    """
    advance = left.forward + reached.forward
    turn = left.yaw_rate + reached.yaw_rate
    return ManeuverError(
        duration=-abs(size.duration),
        forward=_with_sign_of(size.forward, -advance or -1.0),
        side=_with_sign_of(size.side, -turn or -1.0),
        heading_change=_with_sign_of(size.heading_change, turn or -1.0),
    )


def _with_sign_of(size: float, value: float) -> float:
    return copysign(abs(size), value) if value else abs(size)
