"""Plan view of a flight: track by primitive, goal, plans and wind."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.offsetbox import AnchoredOffsetbox, DrawingArea, HPacker, TextArea
from matplotlib.patches import FancyArrowPatch

from flight.plan.planned_track import planned_track
from flight.se2 import SE2
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.mission_attachments import logged_goal, logged_plans
from flightlog.primitives import FlownPrimitive, PrimitiveKind, merged_primitives
from flightlog.topics import ESTIMATE, WIND
from flightlog.trim_labels import trim_label, trim_names, trim_palette
from review.summary.bound_check import pose_at

from . import palette, stroke
from .labels import Label, place_labels
from .marks import draw_goal, draw_heading_marker
from .palette import format_map_axes

# Candidate steps between the times written along the track, s; the first with at most `MOST_TIMES` is used.
TIME_STEPS = (1, 2, 5, 10, 20, 30, 60, 120, 300, 600)
MOST_TIMES = 12

# Length of the wind arrow in points.
WIND_ARROW = 30.0

# Position of legend and wind, as a share of the plan view's height.
BELOW = -0.08


def draw_track(axes: Axes, log: FlightLog) -> None:
    """Draws the plan view of a flight, north up, with equal scales.

    Labels are placed in the space that is free now, so the rest of the figure should be complete.

    Raises:
        FlightError: the log lacks positions, or an attachment is broken.
    """
    format_map_axes(axes)
    handles = _draw_primitives(axes, log) + _draw_plans(axes, log)
    labels = [*_draw_ends(axes, log), *_draw_times(axes, log)]
    goal = logged_goal(log)
    if goal is not None:
        handles.append(draw_goal(axes, goal))
    axes.margins(0.12)
    if WIND.name in log.series:
        _draw_wind(axes, log)
    axes.legend(
        handles=handles,
        fontsize=palette.SMALL_TEXT,
        frameon=True,
        framealpha=0.85,
        edgecolor="none",
        loc="upper left",
        bbox_to_anchor=(0.0, BELOW),
        ncols=3,
        borderaxespad=0.0,
        handlelength=2.6,
    )
    motion = log.motion
    place_labels(axes, labels, [np.column_stack([motion["east"], motion["north"]])])


def _draw_primitives(axes: Axes, log: FlightLog) -> list[Line2D]:
    flown = merged_primitives(log)
    colors = trim_palette(log)
    for part in flown:
        track = _track(log, part)
        if part.kind is PrimitiveKind.COAST:
            stroke.trim_stroke(colors[part.id]).draw(axes, *track)
        else:
            stroke.MANEUVER.draw(axes, *track)
    if not flown:
        motion = log.motion
        estimated = motion.topic.name == ESTIMATE.name
        line = stroke.ESTIMATED if estimated else stroke.ACTUAL
        line.draw(axes, motion["east"], motion["north"])
        return [line.entry("estimated track" if estimated else "flown")]
    names = trim_names(log)
    held = sorted({part.id for part in flown if part.kind is PrimitiveKind.COAST})
    handles = [stroke.trim_stroke(colors[trim]).entry(trim_label(trim, names)) for trim in held]
    if any(part.kind is PrimitiveKind.MANEUVER for part in flown):
        handles.append(stroke.MANEUVER.entry("maneuver between trims"))
    return handles


def _track(log: FlightLog, part: FlownPrimitive) -> Float[np.ndarray, "2 n"]:
    """Returns east and north during a primitive, both ends included."""
    motion = log.motion
    inside = (motion.time > part.start) & (motion.time < part.end)
    time = np.concatenate([[part.start], motion.time[inside], [part.end]])
    return np.stack([np.interp(time, motion.time, motion[name]) for name in ("east", "north")])


def _draw_ends(axes: Axes, log: FlightLog) -> Iterator[Label]:
    """Marks start and end by darts along the heading; yields their labels."""
    for time, name, fill, turned in ((0.0, "start", palette.INK, 0.5), (log.duration, "end", "white", -0.5)):
        pose = pose_at(log, time)
        draw_heading_marker(axes, pose, fill=fill)
        yield Label(pose, name, turned * np.pi)


def _draw_times(axes: Axes, log: FlightLog) -> Iterator[Label]:
    """Marks times along the track; yields their labels."""
    longest = TIME_STEPS[-1] * np.ceil(log.duration / (TIME_STEPS[-1] * MOST_TIMES))
    step = next((step for step in TIME_STEPS if log.duration / step <= MOST_TIMES), longest)
    for time in np.arange(step, log.duration - 0.4 * step, step):
        pose = pose_at(log, float(time))
        axes.plot(pose.y, pose.x, "o", color="white", markeredgecolor=palette.INK, markersize=4, zorder=6)
        yield Label(pose, f"{time:.0f} s")


def _draw_plans(axes: Axes, log: FlightLog) -> list[Line2D]:
    """Draws each plan from the estimated pose at its time."""
    plans = logged_plans(log)
    if not plans or LIBRARY_ATTACHMENT not in log.attachments or ESTIMATE.name not in log.series:
        return []
    library, estimate = log.library(), log[ESTIMATE]
    for place, planning in enumerate(plans):
        x, y, heading = (
            float(np.interp(planning.time, estimate.time, estimate[name]))
            for name in ("north", "east", "heading")
        )
        plan, start = planning.plan, SE2(x, y, heading)
        lines = planned_track(
            library, plan.sequence, plan.coasting_times, start=start, gamma=plan.deciding.gamma
        )
        for line in (*lines[0], *lines[1]):
            style = stroke.FIRST_PLAN if place == 0 else stroke.LATER_PLAN
            style.draw(axes, line[:, 1], line[:, 0])
    handles = [stroke.FIRST_PLAN.entry("first plan")]
    if len(plans) > 1:
        handles.append(stroke.LATER_PLAN.entry(f"later plans: {len(plans) - 1}"))
    return handles


def _draw_wind(axes: Axes, log: FlightLog) -> None:
    """Draws the mean wind as an arrow along the air's motion."""
    wind = log[WIND]
    north, east = float(wind["north"].mean()), float(wind["east"].mean())
    speed = float(np.hypot(north, east))
    if speed < 0.05:
        return
    canvas = DrawingArea(WIND_ARROW, WIND_ARROW, 0, 0)
    along = 0.5 * WIND_ARROW * np.array([east, north]) / speed
    middle = np.full(2, 0.5 * WIND_ARROW)
    canvas.add_artist(
        FancyArrowPatch(
            tuple(middle - along),
            tuple(middle + along),
            arrowstyle="-|>",
            mutation_scale=14,
            color=palette.INK,
            linewidth=1.6,
            shrinkA=0,
            shrinkB=0,
        )
    )
    words = TextArea(f"mean wind\n{speed:.1f} m/s", textprops={"fontsize": palette.SMALL_TEXT, "ha": "left"})
    packed = HPacker(children=[canvas, words], align="center", pad=2, sep=6)
    box = AnchoredOffsetbox(
        "upper right",
        child=packed,
        frameon=False,
        pad=0.0,
        borderpad=0.0,
        bbox_to_anchor=(1.0, BELOW),
        bbox_transform=axes.transAxes,
    )
    axes.add_artist(box)
