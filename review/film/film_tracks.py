"""Overlays of a film: flown track, planned track, goal and shadow."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import mujoco
import numpy as np
from jaxtyping import Float

from flight.plan.planned_track import planned_track
from flight.se2 import SE2
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.mission_attachments import logged_goal, logged_plans, logged_sequence
from flightlog.topics import ESTIMATE

Points = Float[np.ndarray, "_ 3"]
FLOWN, PLANNED, GOAL = (0.90, 0.36, 0.05, 1.0), (0.10, 0.27, 0.62, 0.9), (0.0, 0.62, 0.45, 0.45)
"""Red, green, blue and opacity."""

_SHADOW = (0.05, 0.08, 0.05, 0.40)
# Flown track: spacing of its points, s; distance below the vehicle, m, at the skids.
_FLOWN_STEP, _BELOW = 0.1, 0.6
_NO_TURN = np.eye(3).ravel()


@dataclass(frozen=True, slots=True, eq=False)
class PlannedTrack:
    """Lines of a plan in MuJoCo's world, in force from `time`, s."""

    time: float
    lines: tuple[Points, ...]


def planned_tracks(log: FlightLog) -> tuple[PlannedTrack, ...]:
    """Returns the tracks of a mission's plans or of a sequence.

    Empty where the log has neither.

    Raises:
        FlightError: an attachment is broken.
    """
    if LIBRARY_ATTACHMENT not in log.attachments:
        return ()
    library, found = log.library(), []
    plans = logged_plans(log)
    for planning in plans:
        plan, (start, height) = planning.plan, _estimated_pose(log, planning.time)
        gamma = plan.deciding.gamma
        walk = planned_track(library, plan.sequence, plan.coasting_times, start=start, gamma=gamma)
        found.append(PlannedTrack(planning.time, _lines_at_height(walk, height)))
    flown = None if plans else logged_sequence(log)
    if flown is not None:
        walk = planned_track(library, flown.trims, flown.coasting_times, start=flown.start)
        found.append(PlannedTrack(0.0, _lines_at_height(walk, flown.altitude)))
    return tuple(found)


def _estimated_pose(log: FlightLog, time: float) -> tuple[SE2, float]:
    """Returns estimated pose and height at a time; true without an estimate."""
    states = log[ESTIMATE] if ESTIMATE.name in log.series else log.motion
    north, east, down, heading = (
        float(np.interp(time, states.time, states[name])) for name in ("north", "east", "down", "heading")
    )
    return SE2(north, east, heading), -down


def _lines_at_height(
    walk: tuple[tuple[Float[np.ndarray, "_ 2"], ...], ...], height: float
) -> tuple[Points, ...]:
    """Returns coasts and maneuvers as lines in MuJoCo's north-west-up world."""
    flip = np.array([1.0, -1.0])
    return tuple(
        np.column_stack([line * flip, np.full(len(line), height - _BELOW)]) for part in walk for line in part
    )


class FilmTracks:
    """Tracks, goal and shadow for the scenes of one flight.

    Args:
        log: the flight.

    Raises:
        FlightError: an attachment is broken.
    """

    def __init__(self, log: FlightLog) -> None:
        motion = log.motion
        self._times = np.arange(0.0, log.duration, _FLOWN_STEP)
        flown = [np.interp(self._times, motion.time, motion[name]) for name in ("north", "east", "down")]
        self._flown = np.column_stack([flown[0], -flown[1], -flown[2] - _BELOW])
        self._planned, self._goal = planned_tracks(log), logged_goal(log)
        self._height = -float(motion["down"][0])

    def add_to(self, scene: mujoco.MjvScene, *, time: float, place: Sequence[float]) -> None:
        """Adds the overlays of a time to a scene.

        Args:
            scene: the scene to draw.
            time: s since the start.
            place: vehicle position in MuJoCo's world, m.
        """
        done = self._times < time
        under = (place[0], place[1], place[2] - _BELOW)
        _draw_line(scene, np.vstack([self._flown[done], under]), FLOWN, width=5.0)
        for line in self._in_force(time):
            _draw_line(scene, line, PLANNED, width=3.0)
        _draw_disc(scene, (place[0], place[1], 0.02), radius=1.5, color=_SHADOW)
        if self._goal is not None:
            north, east = self._goal.position
            radius = max(self._goal.tolerance, 0.3)
            _draw_disc(scene, (north, -east, self._height - _BELOW), radius=radius, color=GOAL)
            _draw_line(scene, np.array([(north, -east, 0.0), (north, -east, self._height)]), GOAL, width=3.0)

    def _in_force(self, time: float) -> Iterator[Points]:
        """Yields the lines of the latest plan."""
        made = [plan for plan in self._planned if plan.time <= time]
        if made:
            yield from made[-1].lines


def _draw_line(scene: mujoco.MjvScene, points: Points, color: Sequence[float], *, width: float) -> None:
    """Adds a line, width in pixels, until the scene is full."""
    for start, end in pairwise(points):
        geom = _next_geom(scene, mujoco.mjtGeom.mjGEOM_LINE, np.zeros(3), np.zeros(3), color)
        if geom is None:
            return
        mujoco.mjv_connector(geom, mujoco.mjtGeom.mjGEOM_LINE, width, start, end)


def _draw_disc(
    scene: mujoco.MjvScene, middle: Sequence[float], *, radius: float, color: Sequence[float]
) -> None:
    """Adds a flat disc, unless the scene is full."""
    size = np.array([radius, 0.01, 0.0])
    _next_geom(scene, mujoco.mjtGeom.mjGEOM_CYLINDER, size, np.array(middle), color)


def _next_geom(
    scene: mujoco.MjvScene, kind: mujoco.mjtGeom, size: np.ndarray, place: np.ndarray, color: Sequence[float]
) -> mujoco.MjvGeom | None:
    """Adds a matte geom; None where the scene is full."""
    if scene.ngeom >= scene.maxgeom:
        return None
    geom = scene.geoms[scene.ngeom]
    mujoco.mjv_initGeom(geom, kind, size, place, _NO_TURN, np.array(color, dtype=np.float32))
    geom.specular, geom.emission = 0.0, 0.6
    scene.ngeom += 1
    return geom
