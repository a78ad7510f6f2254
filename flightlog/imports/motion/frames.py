"""Axes of imported motion, held against the motion itself."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Literal

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flightlog.imports.axes import Axes, BodyAxes, WorldAxes
from flightlog.imports.measured_motion import Source, measured_states, velocity_disagreement
from flightlog.series import Series
from flightlog.topics import ESTIMATE

VelocityAxes = Literal["world", "body"]
QuaternionOrder = Literal["wxyz", "xyzw"]

MOST_DIFFERENT, LEAST_DIFFERENCE = 0.25, 0.1
"""Largest difference of velocities and positions: share of the speed, and m/s."""

_EXCERPT = 20_000
_SURE = 0.5
"""Difference of two combinations' mean upward cosines that decides."""


class FrameError(FlightError):
    """Axes that the motion contradicts."""


@dataclass(frozen=True, slots=True)
class Frames:
    """Axes of world and body, axes of velocities, order of quaternions."""

    world: WorldAxes = "ned"
    body: BodyAxes = "frd"
    velocity_in: VelocityAxes = "world"
    quaternion: QuaternionOrder = "wxyz"

    @property
    def axes(self) -> Axes:
        """Axes of world and body."""
        return Axes(self.world, self.body)

    def quaternions(self, listed: Float[np.ndarray, "n 4"]) -> Float[np.ndarray, "n 4"]:
        """Returns quaternions w, x, y, z in our axes."""
        return self.axes.in_ned_frd(listed if self.quaternion == "wxyz" else listed[:, [3, 0, 1, 2]])


Build = Callable[[Frames], Sequence[Source]]
"""Makes the sources of a motion in stated axes."""


def velocity_source(
    time: Float[np.ndarray, "n"], velocity: Float[np.ndarray, "n 3"], frames: Frames
) -> Source:
    """Returns velocities along the axes of the world or the body."""
    if frames.velocity_in == "world":
        north, east, down = frames.axes.in_world(velocity).T
        return Source(time, {"velocity_north": north, "velocity_east": east, "velocity_down": down})
    forward, right, down = frames.axes.in_body(velocity).T
    return Source(time, {"body_forward": forward, "body_right": right, "body_down": down})


def guess_quaternion_order(build: Build, frames: Frames) -> QuaternionOrder:
    """Returns the order in which the vehicle stands upright.

    Raises:
        FrameError: it does in both or neither.
    """
    up = {}
    orders: tuple[QuaternionOrder, ...] = ("wxyz", "xyzw")
    for order in orders:
        states = measured_states(_excerpt(build(replace(frames, quaternion=order))), ESTIMATE)
        up[order] = -1.0 if states is None else _upright(states)
    if abs(up["wxyz"] - up["xyzw"]) < _SURE or max(up.values()) < _SURE:
        raise FrameError(
            "quaternions are lists, and the motion does not tell their order: give --quaternion-order wxyz "
            "or --quaternion-order xyzw"
        )
    return max(orders, key=lambda order: up[order])


def check_frames(build: Build, frames: Frames) -> None:
    """Refuses axes that the motion contradicts, and names those that fit.

    Velocities must be the slope of the position, and the vehicle must not be upside down.

    Args:
        build: makes the sources in given axes.
        frames: the axes.

    Raises:
        FrameError: they contradict; the message names the combination that fits best.
    """
    reason, _ = _contradiction(build, frames)
    if not reason:
        return
    fitting = []
    worlds: tuple[WorldAxes, ...] = ("ned", "enu")
    bodies: tuple[BodyAxes, ...] = ("frd", "flu")
    along: tuple[VelocityAxes, ...] = ("world", "body")
    for world, body, velocity_in in product(worlds, bodies, along):
        other = replace(frames, world=world, body=body, velocity_in=velocity_in)
        wrong, error = _contradiction(build, other)
        if not wrong:
            fitting.append((len(_changes(frames, other)), error, " ".join(_changes(frames, other))))
    best = min(fitting, default=None)
    advice = f"give {best[2]}" if best else "no axes fit; give --unchecked to import it as it is"
    raise FrameError(f"{reason}: {advice}")


def _changes(frames: Frames, other: Frames) -> list[str]:
    pairs = (
        ("--world", frames.world, other.world),
        ("--body", frames.body, other.body),
        ("--velocity-in", frames.velocity_in, other.velocity_in),
    )
    return [f"{option} {new}" for option, old, new in pairs if old != new]


def _contradiction(build: Build, frames: Frames) -> tuple[str, float]:
    """Returns the contradiction of axes and motion, if any, and the error."""
    states = measured_states(_excerpt(build(frames)), ESTIMATE)
    if states is None:
        return "", 0.0
    if _upright(states) < 0.0:
        return "inverted flight most of the time", np.inf
    apart = velocity_disagreement(states)
    if apart is not None and apart[0] > max(MOST_DIFFERENT * apart[1], LEAST_DIFFERENCE):
        return (
            f"velocities differ from the slope of the positions by {apart[0]:.2f} m/s at a speed of "
            f"{apart[1]:.2f} m/s",
            apart[0],
        )
    return "", apart[0] if apart else 0.0


def _upright(states: Series) -> float:
    """Returns the mean cosine of the tilt; 1 if unknown."""
    if not states.has_fields("roll", "pitch"):
        return 1.0
    cosines = np.cos(states["roll"]) * np.cos(states["pitch"])
    known = cosines[np.isfinite(cosines)]
    return float(known.mean()) if len(known) else 1.0


def _excerpt(sources: Sequence[Source]) -> list[Source]:
    """Returns the middle of long sources."""
    longest = max(sources, key=lambda source: len(source.time), default=None)
    if longest is None or len(longest.time) <= _EXCERPT:
        return list(sources)
    middle = len(longest.time) // 2
    start, end = longest.time[middle - _EXCERPT // 2], longest.time[middle + _EXCERPT // 2 - 1]
    cut = []
    for source in sources:
        inside = (source.time >= start) & (source.time <= end)
        cut.append(
            Source(source.time[inside], {name: column[inside] for name, column in source.columns.items()})
        )
    return cut
