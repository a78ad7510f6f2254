"""Every performance of every maneuver on one another, and how far off they are, with the bounds claimed."""

from collections.abc import Mapping, Sequence
from math import ceil, degrees

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim

from . import palette

COLUMNS = 6
# More maneuvers than this do not fit on a page; the first ones are shown, and the title says so.
MAX_MANEUVERS = 48

# Inches a primitive, and how many bounds a histogram reaches; what lies further is put at its end.
LINE, HISTOGRAM_LIMIT = 0.36, 1.45
BINS = np.linspace(-HISTOGRAM_LIMIT, HISTOGRAM_LIMIT, 59)
# What lies on the bound is inside it, in the last bin before it.
AT_BOUND = 1 - 1e-9

_TRIM_NUMBERS = (
    ("forward speed", 1.0, "m/s"),
    ("side speed", 1.0, "m/s"),
    ("yaw rate", degrees(1.0), "deg/s"),
)
_MANEUVER_NUMBERS = (
    ("duration", 1.0, "s"),
    ("ahead", 1.0, "m"),
    ("to the right", 1.0, "m"),
    ("heading change", degrees(1.0), "deg"),
)

Numbers = Float[np.ndarray, "scalars"]

Tracks = Mapping[int, Sequence[Float[np.ndarray, "n 2"]]]
Rows = Mapping[int, Float[np.ndarray, "n k"]]


def repeatability_picture(library: Library, tracks: Tracks) -> Figure:
    """Returns the tracks of all performances, seen from their entry, a panel for each maneuver (Figure 6)."""
    shown = [row for row in library.maneuvers if row.id in tracks][:MAX_MANEUVERS]
    rows = ceil(len(shown) / COLUMNS)
    figure = palette.new_figure(17.0, 1.2 + 2.9 * rows)
    _title(figure, f"{library.name}: maneuvers are repeatable", shown, library)
    panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axes, row in zip(panels, shown, strict=False):
        for track in tracks[row.id]:
            axes.plot(track[:, 1], track[:, 0], color=palette.TRUE_COLOR, linewidth=0.5, alpha=0.35)
            axes.plot(track[-1, 1], track[-1, 0], ".", color=palette.INK, markersize=2.0)
        moved, error = row.displacement, row.error
        axes.add_patch(
            Rectangle(
                (moved.y - abs(error.side), moved.x - abs(error.forward)),
                2 * abs(error.side),
                2 * abs(error.forward),
                fill=False,
                edgecolor=palette.ALARM,
                linewidth=1.2,
                zorder=5,
            )
        )
        palette.format_axes(axes)
        axes.set_aspect("equal", adjustable="datalim")
        palette.draw_headline(axes, _name(row))
    for axes in panels[len(shown) :]:
        axes.set_visible(False)
    figure.supxlabel("to the right of the heading at entry, m; the box: where the library says that it ends")
    figure.supylabel("ahead, m")
    return figure


def deviations_picture(library: Library, trims: Rows, maneuvers: Rows) -> Figure:
    """Returns histograms of all deviations from the library's values, as shares of its bounds.

    A line for each primitive, a column for each of its numbers; its bound is written beside it.

    Args:
        library: values and errors.
        trims: by trim, the furthest deviations: forward, side, yaw rate, a row for each flight.
        maneuvers: by maneuver, duration, forward, side, heading change, a row for each performance.
    """
    held = [trim for trim in library.trims if trim.id in trims]
    shown = [row for row in library.maneuvers if row.id in maneuvers][:MAX_MANEUVERS]
    heights = [max(len(lines), 1) + 1.6 for lines in (held, shown)]
    figure = palette.new_figure(17.0, 0.8 + LINE * sum(heights))
    _title(figure, f"{library.name}: deviations in all flights, as shares of the bounds", shown, library)
    upper, lower = figure.subfigures(2, 1, height_ratios=heights, squeeze=False)[:, 0]
    _histograms(
        upper.subplots(1, 4, sharey=True),
        _TRIM_NUMBERS,
        [(f"trim {trim.id}", trims[trim.id], _trim_bounds(trim)) for trim in held],
    )
    _histograms(
        lower.subplots(1, 4, sharey=True),
        _MANEUVER_NUMBERS,
        [(_name(row), maneuvers[row.id] - _values(row), _maneuver_bounds(row)) for row in shown],
    )
    figure.supxlabel(
        "deviation over bound, which is written beside it; between the red lines lies what the library says",
        fontsize=palette.TEXT_SIZE + 1,
    )
    return figure


def _trim_bounds(trim: Trim) -> Numbers:
    return np.abs([trim.error.forward, trim.error.side, trim.error.yaw_rate])


def _values(row: Maneuver) -> Numbers:
    return np.array([row.duration, row.displacement.x, row.displacement.y, row.displacement.heading])


def _maneuver_bounds(row: Maneuver) -> Numbers:
    wrong = row.error
    return np.abs([wrong.duration, wrong.forward, wrong.side, wrong.heading_change])


def _histograms(
    panels: Sequence[Axes],
    numbers: Sequence[tuple[str, float, str]],
    lines: Sequence[tuple[str, Float[np.ndarray, "n k"], Numbers]],
) -> None:
    """Draws a panel for each number, in it a histogram for each primitive, the first on top."""
    for panel in panels[len(numbers) :]:
        panel.set_visible(False)
    for column, (panel, (headline, scale, unit)) in enumerate(zip(panels, numbers, strict=False)):
        palette.format_axes(panel)
        palette.draw_headline(panel, headline)
        for place, (_, off, bounds) in enumerate(lines):
            bound = max(float(bounds[column]), 1e-12)
            counts, edges = np.histogram(
                np.clip(AT_BOUND * off[:, column] / bound, -HISTOGRAM_LIMIT, HISTOGRAM_LIMIT), bins=BINS
            )
            foot, height = -float(place), 0.85 * counts / max(counts.max(), 1)
            panel.stairs(foot + height, edges, baseline=foot, fill=True, color=palette.TRUE_COLOR, alpha=0.75)
            panel.text(
                1.01,
                foot + 0.35,
                f"{scale * bound:.3g} {unit}",
                va="center",
                fontsize=palette.SMALL_TEXT,
                transform=panel.get_yaxis_transform(),
            )
        for side in (-1.0, 1.0):
            panel.axvline(side, color=palette.ALARM, linewidth=1.4)
        panel.set_xlim(-HISTOGRAM_LIMIT, HISTOGRAM_LIMIT)
        panel.set_ylim(-len(lines) + 0.9, 1.1)
        panel.set_yticks([0.35 - place for place in range(len(lines))], [name for name, _, _ in lines])


def _name(row: Maneuver) -> str:
    return f"{row.id}:  {row.from_trim} \N{RIGHTWARDS ARROW} {row.to_trim}"


def _title(figure: Figure, text: str, shown: Sequence[Maneuver], library: Library) -> None:
    part = (
        ""
        if len(shown) == len(library.maneuvers)
        else f" ({len(shown)} of {len(library.maneuvers)} maneuvers)"
    )
    figure.suptitle(text + part, x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 4, fontweight="bold")
