"""The one sign convention of errors, so that gamma = +1 means "fast and wide" for every primitive at once.

Signs come from the *nominal* trims and displacements, never from data, so that they cannot flip with a seed.
"""

from math import copysign

from .maneuver import ManeuverError
from .se2 import Twist


def signed_trim_error(size: Twist, velocity: Twist) -> Twist:
    """Returns the error of a trim with the sign of its nominal value, positive where that is 0.

    Args:
        size: absolute errors, metres per second and radians per second.
        velocity: the nominal body velocity.
    """
    return Twist(
        _like(size.forward, velocity.forward),
        _like(size.side, velocity.side),
        _like(size.yaw_rate, velocity.yaw_rate),
    )


def signed_maneuver_error(
    size: ManeuverError, *, forward_displacement: float, yaw_rate_from: float, yaw_rate_to: float
) -> ManeuverError:
    """Returns the error of a maneuver, signed.

    Durations have negative errors; forward displacement errors oppose the displacement; with
    s = sign(r_from + r_to) the heading-change error has the sign s and the lateral error -s, both negative
    where s = 0.

    Args:
        size: absolute errors in seconds, metres and radians.
        forward_displacement: the nominal displacement along the body axis at entry, metres.
        yaw_rate_from: nominal yaw rate of the trim left, radians per second.
        yaw_rate_to: nominal yaw rate of the trim reached, radians per second.
    """
    turn = yaw_rate_from + yaw_rate_to
    return ManeuverError(
        duration=-abs(size.duration),
        forward=_like(size.forward, -forward_displacement if forward_displacement else -1.0),
        side=_like(size.side, -turn) if turn else -abs(size.side),
        heading_change=_like(size.heading_change, turn) if turn else -abs(size.heading_change),
    )


def _like(size: float, value: float) -> float:
    return copysign(abs(size), value) if value else abs(size)
