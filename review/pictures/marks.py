"""Marks on a map: pose, goal, annotation."""

from math import cos, sin

from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.patches import Circle
from matplotlib.path import Path
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D

from flight.mission.destination import Destination
from flight.se2 import SE2

from . import palette

# Points north.
HEADING_MARKER = Path([(0.0, 1.0), (0.6, -0.8), (0.0, -0.35), (-0.6, -0.8), (0.0, 1.0)], closed=True)


def draw_heading_marker(axes: Axes, pose: SE2, *, fill: str) -> None:
    """Draws a dart along the heading of a pose."""
    # Markers point up, that is north, and turn counter-clockwise.
    marker = MarkerStyle(HEADING_MARKER, transform=Affine2D().rotate(-pose.heading))
    axes.plot(
        pose.y,
        pose.x,
        marker=marker,
        markersize=14,
        markerfacecolor=fill,
        markeredgecolor=palette.INK,
        linestyle="none",
        zorder=7,
    )


def annotate_pose(axes: Axes, pose: SE2, text: str, *, away: float = 1.0, along: bool = False) -> None:
    """Writes a text beside a pose, to its right or ahead."""
    east, north = sin(pose.heading), cos(pose.heading)
    x, y = (east, north) if along else (north, -east)
    axes.annotate(
        text,
        (pose.y, pose.x),
        xytext=(16 * away * x, 14 * away * y),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize=palette.SMALL_TEXT,
        color=palette.INK,
        path_effects=[withStroke(linewidth=2.5, foreground="white")],
        zorder=8,
    )


def draw_goal(axes: Axes, goal: Destination) -> Line2D:
    """Draws the goal and its tolerance; returns the legend entry."""
    north, east = goal.position
    if goal.tolerance:
        fill = Circle((east, north), goal.tolerance, color=palette.GOAL, alpha=0.22, linewidth=0, zorder=2)
        edge = Circle(
            (east, north), goal.tolerance, fill=False, edgecolor=palette.GOAL, linewidth=1.2, zorder=3
        )
        axes.add_patch(fill)
        axes.add_patch(edge)
    axes.plot(east, north, marker="+", color=palette.GOAL, markersize=11, markeredgewidth=2, zorder=5)
    within = f"within {goal.tolerance:.3g} m" if goal.tolerance else "exactly"
    return Line2D(
        [],
        [],
        color=palette.GOAL,
        marker="+",
        markersize=9,
        markeredgewidth=2,
        linestyle="none",
        label=f"goal, {within}",
    )
