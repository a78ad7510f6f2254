"""Fields of a state that follow from measured ones."""

from collections.abc import Iterator, Mapping

import numpy as np
from jaxtyping import Float

Column = Float[np.ndarray, "n"]

BODY_RATES = ("roll_rate", "pitch_rate", "body_yaw_rate")
WORLD_RATES = ("turn_north", "turn_east", "turn_down")
HEADING_RATE = "heading_rate"
"""Names of measured rates: about body axes, about world axes, and of the heading."""

_MIN_COS_PITCH = 0.01


def body_rates(known: Mapping[str, Column]) -> Iterator[tuple[str, Column]]:
    """Yields body rates from rates about the world axes."""
    if not {*WORLD_RATES, "roll", "pitch", "heading"} <= known.keys():
        return
    north, east, down = (known[name] for name in WORLD_RATES)
    (cr, cp, ch), (sr, sp, sh) = (
        [turn(known[name]) for name in ("roll", "pitch", "heading")] for turn in (np.cos, np.sin)
    )
    ahead, right = ch * north + sh * east, ch * east - sh * north
    below = sp * ahead + cp * down
    yield "roll_rate", cp * ahead - sp * down
    yield "pitch_rate", cr * right + sr * below
    yield "body_yaw_rate", cr * below - sr * right


def level_velocities(known: Mapping[str, Column]) -> Iterator[tuple[str, Column]]:
    """Yields velocities along and across the heading, and down."""
    if {"velocity_north", "velocity_east", "heading"} <= known.keys():
        c, s = np.cos(known["heading"]), np.sin(known["heading"])
        yield "forward", c * known["velocity_north"] + s * known["velocity_east"]
        yield "side", c * known["velocity_east"] - s * known["velocity_north"]
    if "velocity_down" in known:
        yield "descent", known["velocity_down"]
    if {"body_forward", "body_right", "body_down", "roll", "pitch"} <= known.keys():
        u, v, w = (known[f"body_{axis}"] for axis in ("forward", "right", "down"))
        roll, pitch = known["roll"], known["pitch"]
        below = np.sin(roll) * v + np.cos(roll) * w
        yield "forward", np.cos(pitch) * u + np.sin(pitch) * below
        yield "side", np.cos(roll) * v - np.sin(roll) * w
        yield "descent", np.cos(pitch) * below - np.sin(pitch) * u
    elif {"body_forward", "body_right"} <= known.keys() and not {"roll", "pitch"} & known.keys():
        # A vehicle in the plane: its axes are level.
        yield "forward", known["body_forward"]
        yield "side", known["body_right"]
        if "body_down" in known:
            yield "descent", known["body_down"]


def yaw_rate(known: Mapping[str, Column]) -> Column | None:
    """Returns the heading's rate by body rates, else its slope."""
    if not {"pitch_rate", "body_yaw_rate", "roll", "pitch"} <= known.keys():
        return known.get(HEADING_RATE)
    upright = np.cos(known["pitch"])
    # The yaw rate is singular at vertical pitch.
    level = np.where(np.abs(upright) > _MIN_COS_PITCH, upright, np.nan)
    turning = known["pitch_rate"] * np.sin(known["roll"]) + known["body_yaw_rate"] * np.cos(known["roll"])
    return np.asarray(turning / level)
