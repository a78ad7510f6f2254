"""The way that velocities make, for logs that do not say where the vehicle was."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from .topic import Field, Series

_POSITION_FIELDS = (
    Field("north", "m", "way made from the first sample on"),
    Field("east", "m", "way made from the first sample on"),
)


def with_dead_reckoning(motion: Series) -> Series:
    """Returns a motion with positions: its own, or the way made from its start by its velocities.

    A displacement over seconds comes out as well as the velocities are known; a position on a map does not,
    which is why no log is given one.

    Raises:
        MissingFieldError: it has neither positions nor velocities and headings.
    """
    if motion.has_fields("north", "east"):
        return motion
    c, s = np.cos(motion["heading"]), np.sin(motion["heading"])
    forward, side = motion["forward"], motion["side"]
    ways = [
        _integrate_velocity(motion.time, velocity)
        for velocity in (c * forward - s * side, s * forward + c * side)
    ]
    kept = [field for field in motion.topic.fields if field.name not in {"north", "east"}]
    topic = replace(motion.topic, fields=(*kept, *_POSITION_FIELDS), numbers=())
    return Series(topic, motion.time, np.column_stack([*(motion[field.name] for field in kept), *ways]))


def _integrate_velocity(
    time: Float[np.ndarray, "n"], velocity: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n"]:
    return np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
