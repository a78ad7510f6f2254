"""Discovery of an unknown vehicle's trims and maneuvers from its motion."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from flight.automaton.conditions import Conditions
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.maneuver_end import Band, ManeuverEnd
from flight.automaton.trim import Trim
from flight.errors import FlightError
from flight.se2 import SE2, Twist

from .motion_matching import TrimGraph
from .motion_model import downsample, learn_model, likeliest_walk
from .motion_walk import all_edges

# Least duration of a steady velocity, s; means over a fifth of it are compared.
LEAST_HOLD = 1.5
PIECES = 5
# Largest deviation of such a mean, as a share of the least difference between two trims.
STEADY = 0.35
# Least difference between two trims: share of a channel's range, and floors in m/s, m/s, rad/s.
RESOLUTION, FLOORS = 0.06, (0.2, 0.2, 0.02)
# Least share of the steady time in a trim; more steady windows than `MOST_WINDOWS` are thinned.
LEAST_SHARE, MOST_WINDOWS = 0.01, 2000
# Default maneuver-end rule: bands in robust standard deviations (clipped by the resolution), dwell and
# time-out in response times of the vehicle.
BAND_IN_SCATTERS, DWELL, TIMEOUT = 4.0, 1.0, 15.0
MAD = 0.6745
_ADVICE = "change --resolution, give --trims, or longer flights with steps between trims"

MotionSamples = Float[np.ndarray, "_ 3"]


class NoTrimsError(FlightError):
    """Fewer than two steady velocities were found."""


@dataclass(frozen=True, slots=True)
class Resolution:
    """Least difference between two trims, m/s, m/s and rad/s."""

    forward: float
    side: float
    yaw_rate: float


def default_resolution(motions: Sequence[MotionSamples]) -> Resolution:
    """Returns the default least difference between two trims."""
    low, high = np.percentile(np.concatenate(motions), [1, 99], axis=0)
    return Resolution(*np.maximum(RESOLUTION * (high - low), FLOORS).tolist())


def discover_automaton(
    motions: Sequence[MotionSamples], *, vehicle: str, resolution: Resolution | None = None
) -> Library:
    """Discovers trims, maneuvers and a maneuver-end rule from motions.

    Values of maneuvers and all errors are zero; `identify` finds them.

    Args:
        motions: one per flight, from `motion_model.sampled_motion`.
        vehicle: name of the vehicle.
        resolution: least difference between two trims.

    Raises:
        NoTrimsError: fewer than two steady velocities were found.
    """
    step = resolution or default_resolution(motions)
    width = np.array([step.forward, step.side, step.yaw_rate])
    velocity = _densest_velocities(motions, width)
    guess = TrimGraph(
        velocity, np.tile(0.5 * width, (len(velocity), 1)), all_edges(len(velocity)), LEAST_HOLD / 2
    )
    model = learn_model(motions, guess)
    walks = [likeliest_walk(motion, guess, model) for motion in motions]
    off: list[list[MotionSamples]] = [[] for _ in velocity]
    edges: set[tuple[int, int]] = set()
    for motion, walk in zip(motions, walks, strict=True):
        sampled = downsample(motion, model.period)
        edges |= {(one.left, one.reached) for one in walk.steps}
        changes = [0, *(round(one.time / model.period) for one in walk.steps), len(sampled)]
        trims = [walk.first, *(one.reached for one in walk.steps)]
        for trim, (begin, end) in zip(trims, pairwise(changes), strict=True):
            # The later half between two steps, when the maneuver is over.
            off[trim].append(sampled[(begin + end) // 2 : end])
    used = [place for place, pieces in enumerate(off) if pieces]
    centres = {place: np.median(np.concatenate(off[place]), axis=0) for place in used}
    time_scale = 1 / min(response.frequency for response in model.responses)
    return _library(
        vehicle,
        {place: _round_velocity(centres[place], width) for place in used},
        {place: _band(np.concatenate(off[place]), centres[place], width) for place in used},
        sorted(edges),
        time_scale,
    )


def _densest_velocities(motions: Sequence[MotionSamples], width: Float[np.ndarray, "3"]) -> MotionSamples:
    """Returns the densest steady velocities, separated by the width."""
    windows = np.concatenate([_steady_window_means(motion, width) for motion in motions])
    if len(windows) < 2:
        raise NoTrimsError(
            f"expected steady velocities of {LEAST_HOLD:g} s, within {_describe_width(STEADY * width)}; "
            f"got {len(windows)}: {_ADVICE}"
        )
    thinned = windows[np.linspace(0, len(windows) - 1, min(len(windows), MOST_WINDOWS)).round().astype(int)]
    scaled = thinned / width
    near = (np.abs(scaled[:, None, :] - scaled) <= 0.5).all(axis=2)
    left, centres = np.ones(len(thinned), bool), []
    while left.any():
        peak = np.flatnonzero(left)[np.argmax(near[left].sum(axis=1))]
        members = near[peak] & left
        if members.sum() < max(2, LEAST_SHARE * len(thinned)):
            break
        centre = np.median(thinned[members], axis=0)
        centres.append(centre)
        left &= (np.abs(scaled - centre / width) > 1.0).any(axis=1)
    if len(centres) < 2:
        raise NoTrimsError(
            f"expected two trims or more with differences of {_describe_width(width)}, got {len(centres)}: "
            f"{_ADVICE}"
        )
    found = np.array(centres)
    order = np.lexsort((found[:, 2], found[:, 1], found[:, 0]))
    return found[order]


def _steady_window_means(motion: MotionSamples, width: Float[np.ndarray, "3"]) -> MotionSamples:
    """Returns the mean velocities of all windows of steady velocity."""
    piece = downsample(motion, LEAST_HOLD / PIECES)
    if len(piece) < PIECES:
        return np.empty((0, 3))
    windows = np.lib.stride_tricks.sliding_window_view(piece, PIECES, axis=0)
    mean = windows.mean(axis=2)
    held = (np.abs(windows - mean[:, :, None]).max(axis=2) <= STEADY * width).all(axis=1)
    steady: MotionSamples = mean[held]
    return steady


def _round_velocity(centre: Float[np.ndarray, "3"], width: Float[np.ndarray, "3"]) -> Twist:
    """Rounds a trim's velocity to 0.001; small components become zero."""
    forward, side, yaw_rate = (
        round(float(value), 3) + 0.0 if abs(value) > 0.25 * step else 0.0
        for value, step in zip(centre, width, strict=True)
    )
    return Twist(forward, side, yaw_rate)


def _band(samples: MotionSamples, centre: Float[np.ndarray, "3"], width: Float[np.ndarray, "3"]) -> Band:
    scatter = np.median(np.abs(samples - centre), axis=0) / MAD
    return Band(*np.round(np.clip(BAND_IN_SCATTERS * scatter, 0.4 * width, 1.5 * width), 4).tolist())


def _library(
    vehicle: str,
    velocities: dict[int, Twist],
    bands: dict[int, Band],
    edges: list[tuple[int, int]],
    time_scale: float,
) -> Library:
    ids = {place: number for number, place in enumerate(velocities, start=1)}
    rule = ManeuverEnd(
        {ids[place]: band for place, band in bands.items()},
        dwell=round(DWELL * time_scale, 2),
        timeout=round(TIMEOUT * time_scale, 2),
    )
    nothing = ManeuverError(0.0, 0.0, 0.0, 0.0)
    return Library(
        name="discovered",
        description="Trims and maneuvers found in the motion of flights without commands.",
        vehicle=vehicle,
        trims=tuple(
            Trim(ids[place], _name(velocity), velocity, Twist(0.0, 0.0, 0.0))
            for place, velocity in velocities.items()
        ),
        maneuvers=tuple(
            Maneuver(number, ids[left], ids[reached], 0.0, SE2.identity(), nothing)
            for number, (left, reached) in enumerate(edges, start=1)
        ),
        conditions=Conditions(maneuver_end=rule, trim_error_kind="instantaneous"),
    )


def _name(velocity: Twist) -> str:
    parts = []
    if velocity.forward or not (velocity.side or velocity.yaw_rate):
        parts.append("hover" if not velocity.forward else f"forward {velocity.forward:g} m/s")
    if velocity.side:
        parts.append(f"side {velocity.side:g} m/s")
    if velocity.yaw_rate:
        parts.append(f"{'right' if velocity.yaw_rate > 0 else 'left'} turn {abs(velocity.yaw_rate):g} rad/s")
    return ", ".join(parts)


def _describe_width(width: Float[np.ndarray, "3"]) -> str:
    return f"{width[0]:.2g} m/s forward, {width[1]:.2g} m/s to the side or {width[2]:.2g} rad/s"
