"""Repeatability of maneuvers: tracks of all performances, deviations over bounds."""

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
# Largest number of maneuvers on a page; only the first are shown, and the title states the count.
MAX_MANEUVERS = 48

# Height per primitive in inches; range of a histogram in bounds, beyond which values are clipped.
LINE, HISTOGRAM_LIMIT = 0.36, 1.45
BINS = np.linspace(-HISTOGRAM_LIMIT, HISTOGRAM_LIMIT, 59)
# A value on the bound belongs to the last bin inside it.
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

Tracks = Mapping[int, Sequence[Float[np.ndarray, "_ 2"]]]
Rows = Mapping[int, Float[np.ndarray, "_ k"]]


def repeatability_picture(library: Library, tracks: Tracks) -> Figure:
    """Returns tracks of all performances, one panel per maneuver (Figure 6)."""
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
    figure.supxlabel("to the right of the heading at entry, m; box: end point bounds of the library")
    figure.supylabel("ahead, m")
    return figure


def deviations_picture(library: Library, trims: Rows, maneuvers: Rows) -> Figure:
    """Returns histograms of all deviations over the library's bounds.

    One line per primitive, one column per value; the bound is written beside it.

    Args:
        library: values and errors.
        trims: largest deviations by trim: forward, side, yaw rate, a row per flight.
        maneuvers: by maneuver, duration, forward, side, heading change, a row per performance.
    """
    held = [trim for trim in library.trims if trim.id in trims]
    shown = [row for row in library.maneuvers if row.id in maneuvers][:MAX_MANEUVERS]
    heights = [max(len(lines), 1) + 1.6 for lines in (held, shown)]
    figure = palette.new_figure(17.0, 0.8 + LINE * sum(heights))
    _title(figure, f"{library.name}: deviations over bounds, all flights", shown, library)
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
        "deviation over bound; the bound is written beside it; red lines: bounds of the library",
        fontsize=palette.TEXT_SIZE + 1,
    )
    return figure


def _trim_bounds(trim: Trim) -> Numbers:
    return np.abs([trim.error.forward, trim.error.side, trim.error.yaw_rate])


def _values(row: Maneuver) -> Numbers:
    return np.array([row.duration, row.displacement.x, row.displacement.y, row.displacement.heading])


def _maneuver_bounds(row: Maneuver) -> Numbers:
    error = row.error
    return np.abs([error.duration, error.forward, error.side, error.heading_change])


def _histograms(
    panels: Sequence[Axes],
    numbers: Sequence[tuple[str, float, str]],
    lines: Sequence[tuple[str, Float[np.ndarray, "_ scalars"], Numbers]],
) -> None:
    """Draws a panel per value with a histogram per primitive."""
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
