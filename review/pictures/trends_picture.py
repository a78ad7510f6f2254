"""Figures 7, 8 and 9 of the thesis for an identified library."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from . import palette

Points = Sequence[tuple[float, float]]

UP, DOWN = palette.TRUE_COLOR, palette.ALARM


def trends_picture(
    title: str,
    *,
    speed_errors: Points,
    displacements: tuple[Points, Points],
    displacement_percents: tuple[Points, Points],
    heading_changes: tuple[Points, Points],
    duration_percents: tuple[Points, Points],
) -> Figure:
    """Returns the page of trends; pairs are steps up and steps down.

    For yaw rates, pairs are steps to the right and to the left.

    Args:
        title: title of the page.
        speed_errors: speed in m/s, forward error in percent.
        displacements: entry speed in m/s, displacement in m.
        displacement_percents: entry speed in m/s, displacement error in percent.
        heading_changes: entry yaw rate in rad/s, heading change in rad.
        duration_percents: entry yaw rate in rad/s, duration error in percent.
    """
    figure = palette.new_figure(16.0, 9.0)
    figure.suptitle(title, x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 4, fontweight="bold")
    turning = any(map(any, heading_changes))
    grid = figure.add_gridspec(2, 3 if turning else 2)
    first = figure.add_subplot(grid[:, 0])
    _draw_points(first, speed_errors, palette.TRUE_COLOR)
    _label(first, "Forward error over speed (Figure 7)", "forward speed, m/s", "largest deviation, %")
    first.set_ylim(bottom=0.0)
    _draw_pair(
        figure.add_subplot(grid[0, 1]),
        displacements,
        ("Steps of speed: displacement (Figure 8)", "speed at entry, m/s", "displacement, m"),
        ("faster", "slower"),
    )
    _draw_pair(
        figure.add_subplot(grid[1, 1]),
        displacement_percents,
        ("Steps of speed: displacement error", "speed at entry, m/s", "largest deviation, %"),
        ("faster", "slower"),
    )
    if not turning:
        return figure
    _draw_pair(
        figure.add_subplot(grid[0, 2]),
        heading_changes,
        ("Steps of yaw rate: heading change (Figure 9)", "yaw rate at entry, rad/s", "heading change, rad"),
        ("to the right", "to the left"),
    )
    _draw_pair(
        figure.add_subplot(grid[1, 2]),
        duration_percents,
        ("Steps of yaw rate: duration error", "yaw rate at entry, rad/s", "largest deviation, %"),
        ("to the right", "to the left"),
    )
    return figure


def _draw_pair(
    axes: Axes, pair: tuple[Points, Points], words: tuple[str, str, str], names: tuple[str, str]
) -> None:
    entries = [_draw_points(axes, points, color) for points, color in zip(pair, (UP, DOWN), strict=True)]
    for entry, name in zip(entries, names, strict=True):
        entry.set_label(name)
    _label(axes, *words)
    axes.legend(handles=entries, frameon=False, fontsize=palette.SMALL_TEXT + 0.5)
    if words[2].endswith("%"):
        axes.set_ylim(bottom=0.0)


def _draw_points(axes: Axes, points: Points, color: str) -> Line2D:
    across, up = [x for x, _ in points], [y for _, y in points]
    (line,) = axes.plot(across, up, "o-", color=color, markersize=5, linewidth=1.4)
    return line


def _label(axes: Axes, headline: str, across: str, up: str) -> None:
    palette.format_axes(axes)
    palette.draw_headline(axes, headline)
    axes.set_xlabel(across, fontsize=palette.TEXT_SIZE)
    axes.set_ylabel(up, fontsize=palette.TEXT_SIZE)
