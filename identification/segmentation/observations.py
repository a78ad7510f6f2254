"""What flights showed of each primitive, flight by flight: for pictures of how repeatable it is."""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flightlog.dead_reckoning import with_dead_reckoning
from flightlog.log import FlightLog

from .segmentation import Segments

# Seconds between the points that are kept of a track.
_SPACING = 0.1


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """What one log shows.

    Attributes:
        tracks: by maneuver, every performance seen from its entry: forward and right, metres.
        maneuvers: by maneuver, a row for each performance: duration, forward, side, heading change.
        trims: by trim, the deviation of largest size of each velocity over all its coasts, with its sign.
    """

    tracks: dict[int, list[Float[np.ndarray, "n 2"]]]
    maneuvers: dict[int, Float[np.ndarray, "n 4"]]
    trims: dict[int, Float[np.ndarray, "3"]]


def observations(log: FlightLog, segments: Segments, library: Library) -> Observations:
    """Returns what a log shows of each primitive, cut as `segmentation` does."""
    motion = with_dead_reckoning(log.motion)
    tracks: defaultdict[int, list[Float[np.ndarray, "n 2"]]] = defaultdict(list)
    rows: defaultdict[int, list[tuple[float, ...]]] = defaultdict(list)
    for one in segments.maneuvers:
        moved = one.displacement
        rows[one.id].append((one.duration, moved.x, moved.y, moved.heading))
        time = np.append(np.arange(0.0, one.duration, _SPACING), one.duration) + one.start
        north, east = (np.interp(time, motion.time, motion[name]) for name in ("north", "east"))
        heading = np.interp(one.start, motion.time, motion["heading"])
        away = np.exp(-1j * heading) * ((north - north[0]) + 1j * (east - east[0]))
        tracks[one.id].append(np.column_stack([away.real, away.imag]))
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
    """Returns the observations of many logs as one; of trims a row for each flight."""
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
