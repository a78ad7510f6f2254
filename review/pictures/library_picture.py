"""Picture of a library: automaton, and all values with signed errors."""

from collections.abc import Callable, Sequence
from math import degrees

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flightlog.trim_labels import trim_colors

from . import palette
from .automaton_picture import MANY_TRIMS, draw_automaton
from .stroke import Stroke

DEGREES_PER_RADIAN = degrees(1.0)
Interval = tuple[float, float]
"""A nominal value and its signed error."""

# Width of a bar in points; opacity of its half towards gamma = -1.
BAR = 6.0
LIGHT_OPACITY = 0.35

TRIM_NUMBERS: tuple[tuple[str, Callable[[Trim], Interval]], ...] = (
    ("forward, m/s", lambda trim: (trim.velocity.forward, trim.error.forward)),
    ("side, m/s", lambda trim: (trim.velocity.side, trim.error.side)),
    (
        "yaw rate, deg/s",
        lambda trim: (
            DEGREES_PER_RADIAN * trim.velocity.yaw_rate,
            DEGREES_PER_RADIAN * trim.error.yaw_rate,
        ),
    ),
)
MANEUVER_NUMBERS: tuple[tuple[str, Callable[[Maneuver], Interval]], ...] = (
    ("duration, s", lambda maneuver: (maneuver.duration, maneuver.error.duration)),
    ("forward, m", lambda maneuver: (maneuver.displacement.x, maneuver.error.forward)),
    ("side, m", lambda maneuver: (maneuver.displacement.y, maneuver.error.side)),
    (
        "heading change, deg",
        lambda maneuver: (
            DEGREES_PER_RADIAN * maneuver.displacement.heading,
            DEGREES_PER_RADIAN * maneuver.error.heading_change,
        ),
    ),
)


def library_picture(library: Library) -> Figure:
    """Returns the picture of a library's automaton and its values."""
    figure = palette.new_figure(17.0, 4.5 + 0.27 * (len(library.trims) + len(library.maneuvers)))
    figure.suptitle(
        f"Library {library.name}    |    {library.vehicle}, wind {library.conditions.wind}",
        x=0.01,
        ha="left",
        fontsize=palette.TEXT_SIZE + 4,
        fontweight="bold",
    )
    halves = figure.add_gridspec(1, 2, width_ratios=(0.42, 0.58))
    graph = figure.add_subfigure(halves[0]).subplots()
    palette.draw_headline(graph, "Trims (circles) and maneuvers (arrows)")
    draw_automaton(graph, library, tall=2.8)
    heights = (len(library.trims) + 4, len(library.maneuvers) + 4)
    rows = halves[1].subgridspec(2, 1, height_ratios=heights)
    draw_trim_errors(figure.add_subfigure(rows[0]), library)
    draw_maneuver_errors(figure.add_subfigure(rows[1]), library)
    return figure


def graph_picture(library: Library) -> Figure:
    """Returns the automaton's graph, as in the thesis's Figures 3 and 4."""
    crowd = len(library.trims) > MANY_TRIMS
    figure = palette.new_figure(14.0 if crowd else 8.0, 11.0 if crowd else 8.4)
    figure.suptitle(
        f"Library {library.name}: {len(library.trims)} trims, {len(library.maneuvers)} maneuvers",
        x=0.01,
        ha="left",
        fontsize=palette.TEXT_SIZE + 3,
        fontweight="bold",
    )
    draw_automaton(figure.subplots(), library, tall=1.6)
    return figure


def draw_trim_errors(figure: Figure | SubFigure, library: Library) -> None:
    """Draws the trims' body velocities with errors, one panel per component."""
    colors = trim_colors(trim.id for trim in library.trims)
    panels = figure.subplots(1, len(TRIM_NUMBERS), sharey=True)
    labels = [f"{trim.name}  {trim.id}" for trim in library.trims]
    for axes, (name, interval) in zip(panels, TRIM_NUMBERS, strict=True):
        _draw_intervals(
            axes, [interval(trim) for trim in library.trims], [colors[trim.id] for trim in library.trims]
        )
        axes.set_xlabel(name, fontsize=palette.TEXT_SIZE)
    _label_rows(panels[0], labels)
    _heading(figure, "Trims: velocity and error")
    palette.draw_legend_above(panels[-1], _interval_entries())


def draw_maneuver_errors(figure: Figure | SubFigure, library: Library) -> None:
    """Draws the maneuvers' values with errors, one panel per value."""
    if not library.maneuvers:
        return
    colors = trim_colors(trim.id for trim in library.trims)
    panels = figure.subplots(1, len(MANEUVER_NUMBERS), sharey=True)
    labels = [
        f"{maneuver.from_trim} \N{RIGHTWARDS ARROW} {maneuver.to_trim}   {maneuver.id:2d}"
        for maneuver in library.maneuvers
    ]
    for axes, (name, interval) in zip(panels, MANEUVER_NUMBERS, strict=True):
        _draw_intervals(
            axes,
            [interval(maneuver) for maneuver in library.maneuvers],
            [colors[maneuver.to_trim] for maneuver in library.maneuvers],
        )
        axes.set_xlabel(name, fontsize=palette.TEXT_SIZE)
    _label_rows(panels[0], labels)
    _heading(figure, "Maneuvers: duration and displacement, in the colour of the target trim")


def _heading(figure: Figure | SubFigure, text: str) -> None:
    figure.suptitle(text, x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 1, fontweight="bold")


def _draw_intervals(axes: Axes, intervals: Sequence[Interval], colors: Sequence[str]) -> None:
    """Draws a row per interval: nominal value and error to both sides."""
    palette.format_axes(axes)
    axes.axvline(0.0, color=palette.FAINT, linewidth=0.8, zorder=1)
    for row, ((nominal, error), color) in enumerate(zip(intervals, colors, strict=True)):
        rows = np.array([row, row], dtype=float)
        Stroke(color, BAR, opacity=LIGHT_OPACITY).draw(axes, np.array([nominal, nominal - error]), rows)
        Stroke(color, BAR).draw(axes, np.array([nominal, nominal + error]), rows)
        axes.plot(nominal, row, "|", color=palette.INK, markersize=9, markeredgewidth=1.4, zorder=5)


def _label_rows(axes: Axes, labels: Sequence[str]) -> None:
    axes.set_yticks(range(len(labels)), labels)
    axes.set_ylim(len(labels) - 0.4, -0.6)


def _interval_entries() -> list[Line2D]:
    nominal = Line2D(
        [], [], marker="|", color=palette.INK, markersize=9, markeredgewidth=1.4, linestyle="none"
    )
    nominal.set_label("nominal")
    return [
        nominal,
        Stroke(palette.INK, BAR).entry("to gamma = +1"),
        Stroke(palette.INK, BAR, opacity=LIGHT_OPACITY).entry("to gamma = \N{MINUS SIGN}1"),
    ]
