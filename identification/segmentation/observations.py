"""Observed tracks and deviations of primitives, for repeatability pictures."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flightlog.dead_reckoning import with_dead_reckoning
from flightlog.log import FlightLog

from .segmentation import Segments

# Spacing of a track's points, seconds, and the most of them.
_SPACING, _MOST_POINTS = 0.1, 10_000


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """Observed primitives of one log.

    Attributes:
        tracks: by maneuver, the track of every performance relative to its entry: forward and right, metres.
        maneuvers: by maneuver, a row per performance: duration, forward, side, heading change.
        trims: by trim, the largest deviation of each velocity over all its coasts, signed.
    """

    tracks: dict[int, list[Float[np.ndarray, "_ 2"]]]
    maneuvers: dict[int, Float[np.ndarray, "_ 4"]]
    trims: dict[int, Float[np.ndarray, "... 3"]]


def observations(log: FlightLog, segments: Segments, library: Library) -> Observations:
    """Returns the observations of a segmented log."""
    motion = with_dead_reckoning(log.motion)
    tracks: defaultdict[int, list[Float[np.ndarray, "n 2"]]] = defaultdict(list)
    rows: defaultdict[int, list[tuple[float, ...]]] = defaultdict(list)
    for maneuver in segments.maneuvers:
        moved = maneuver.displacement
        rows[maneuver.id].append((maneuver.duration, moved.x, moved.y, moved.heading))
        spacing = max(_SPACING, maneuver.duration / _MOST_POINTS)
        time = np.append(np.arange(0.0, maneuver.duration, spacing), maneuver.duration) + maneuver.start
        north, east = (np.interp(time, motion.time, motion[name]) for name in ("north", "east"))
        heading = np.interp(maneuver.start, motion.time, motion["heading"])
        body = np.exp(-1j * heading) * ((north - north[0]) + 1j * (east - east[0]))
        tracks[maneuver.id].append(np.column_stack([body.real, body.imag]))
    off: defaultdict[int, list[Float[np.ndarray, "n 3"]]] = defaultdict(list)
    for coast in segments.coasts:
        velocity = library.trim(coast.trim).velocity
        off[coast.trim].append(coast.velocity - (velocity.forward, velocity.side, velocity.yaw_rate))
    return Observations(
        tracks=dict(tracks),
        maneuvers={number: np.array(found) for number, found in rows.items()},
        trims={number: _largest_deviations(np.concatenate(found)) for number, found in off.items()},
    )


def merge_observations(flights: Iterable[Observations]) -> Observations:
    """Merges the observations of many logs; trims have a row per flight."""
    tracks: defaultdict[int, list[Float[np.ndarray, "n 2"]]] = defaultdict(list)
    maneuvers: defaultdict[int, list[Float[np.ndarray, "n 4"]]] = defaultdict(list)
    trims: defaultdict[int, list[Float[np.ndarray, "3"]]] = defaultdict(list)
    for flight in flights:
        for number, found in flight.tracks.items():
            tracks[number] += found
        for number, rows in flight.maneuvers.items():
            maneuvers[number].append(rows)
        for number, row in flight.trims.items():
            trims[number].append(row)
    return Observations(
        dict(tracks),
        {number: np.concatenate(rows) for number, rows in maneuvers.items()},
        {number: np.array(rows) for number, rows in trims.items()},
    )


def _largest_deviations(off: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "3"]:
    places = np.abs(off).argmax(axis=0)
    furthest: Float[np.ndarray, "3"] = off[places, np.arange(3)]
    return furthest
