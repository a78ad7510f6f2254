"""Dead reckoning for logs without positions."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from .series import Field, Series

_POSITION_FIELDS = (
    Field("north", "m", "dead-reckoned from the first sample"),
    Field("east", "m", "dead-reckoned from the first sample"),
)


def with_dead_reckoning(motion: Series) -> Series:
    """Returns a motion with positions, dead-reckoned if it has none.

    Displacements over seconds are as accurate as the velocities; positions drift, so the result is never
    written to a log.

    Raises:
        MissingFieldError: it has neither positions nor velocities and headings.
    """
    if motion.has_fields("north", "east"):
        return motion
    c, s = np.cos(motion["heading"]), np.sin(motion["heading"])
    forward, side = motion["forward"], motion["side"]
    integrated = [
        _integrate_velocity(motion.time, velocity)
        for velocity in (c * forward - s * side, s * forward + c * side)
    ]
    others = [field for field in motion.topic.fields if field.name not in {"north", "east"}]
    topic = replace(motion.topic, fields=(*others, *_POSITION_FIELDS), numbers=())
    columns = [*(motion[field.name] for field in others), *integrated]
    return Series(topic, motion.time, np.column_stack(columns))


def _integrate_velocity(
    time: Float[np.ndarray, "n"], velocity: Float[np.ndarray, "n"]
) -> Float[np.ndarray, "n"]:
    return np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1]) * np.diff(time))])
