"""Map of expected times around a goal, with a fan of rollouts."""

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure

from experiments.mission.feedback import StatedPolicy
from flight.mission.mission import Mission
from review.pictures import palette
from review.pictures.marks import annotate_pose, draw_goal, draw_heading_marker
from review.pictures.palette import format_map_axes

_CELLS = 240
# Of the distance to the goal: what the map shows around the flights.
_MARGIN = 0.25


def policy_picture(answer: StatedPolicy, mission: Mission) -> Figure:
    """Returns the picture: north up, east right.

    Colours are the seconds that a flight would still take from each place, with heading and trim of the
    start.

    Args:
        answer: policy with its rollouts' tracks.
        mission: the mission.
    """
    figure = palette.new_figure(7.6, 6.4)
    axes = figure.add_subplot()
    format_map_axes(axes)
    tracks = [_world(mission, track) for track in answer.rollouts.tracks]
    north, east = _frame(mission, tracks)
    times = _times(answer, mission, north, east)
    image = axes.pcolormesh(east, north, times, cmap="viridis_r", shading="nearest", rasterized=True)
    figure.colorbar(image, ax=axes, label="expected time from here, s", shrink=0.8)
    for track in tracks:
        axes.plot(track[:, 1], track[:, 0], color=palette.INK, linewidth=0.4, alpha=0.35)
    draw_goal(axes, mission.destination)
    draw_heading_marker(axes, mission.start, fill=palette.INK)
    annotate_pose(axes, mission.start, "start", away=-1.2, along=True)
    said = answer.statement
    mean = "no flight arrives" if said.mean is None else f"{said.mean:.2f} s on average"
    palette.draw_headline(axes, f"{mission.name}, feedback: {mean}; {len(tracks)} of its flights")
    return figure


def _world(mission: Mission, track: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, "points 2"]:
    """Returns points seen from the start as north and east."""
    cosine, sine = np.cos(mission.start.heading), np.sin(mission.start.heading)
    north = mission.start.x + cosine * track[:, 0] - sine * track[:, 1]
    return np.column_stack([north, mission.start.y + sine * track[:, 0] + cosine * track[:, 1]])


def _frame(
    mission: Mission, tracks: list[Float[np.ndarray, "points 2"]]
) -> tuple[Float[np.ndarray, "cells"], Float[np.ndarray, "cells"]]:
    """Returns north and east of the map's cells."""
    points = np.vstack([*tracks, [mission.goal], [mission.start.position]])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = _MARGIN * max(mission.start.distance_to(mission.goal), mission.tolerance) + mission.tolerance
    return (
        np.linspace(low[0] - margin, high[0] + margin, _CELLS),
        np.linspace(low[1] - margin, high[1] + margin, _CELLS),
    )


def _times(
    answer: StatedPolicy,
    mission: Mission,
    north: Float[np.ndarray, "cells"],
    east: Float[np.ndarray, "cells"],
) -> Float[np.ndarray, "cells cells"]:
    policy = answer.policy
    off_north, off_east = np.meshgrid(mission.goal[0] - north, mission.goal[1] - east, indexing="ij")
    cosine, sine = np.cos(mission.start.heading), np.sin(mission.start.heading)
    goals = np.column_stack(
        [
            (cosine * off_north + sine * off_east).ravel(),
            (cosine * off_east - sine * off_north).ravel(),
        ]
    )
    place = policy.table.problem.trims.index(mission.start_trim)
    times = policy.table.times(np.full(len(goals), place), goals)
    return np.asarray(times.reshape(off_north.shape))
