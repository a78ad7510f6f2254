"""Every performance of every maneuver on one another, and how far off they are, with the bounds claimed."""

from collections.abc import Mapping, Sequence
from math import ceil, degrees

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from flight.library import Library
from flight.maneuver import Maneuver

from . import palette

COLUMNS = 6
# More maneuvers than this do not fit on a page; the first ones are shown, and the title says so.
MOST = 48

Tracks = Mapping[int, Sequence[Float[np.ndarray, "n 2"]]]
Rows = Mapping[int, Float[np.ndarray, "n k"]]


def repeatability_picture(library: Library, tracks: Tracks) -> Figure:
    """Returns the tracks of all performances, seen from their entry, a panel for each maneuver (Figure 6)."""
    shown = [row for row in library.maneuvers if row.id in tracks][:MOST]
    rows = ceil(len(shown) / COLUMNS)
    figure = palette.page(17.0, 1.2 + 2.9 * rows)
    _title(figure, f"{library.name}: maneuvers are repeatable", shown, library)
    panels = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axes, row in zip(panels, shown, strict=False):
        for track in tracks[row.id]:
            axes.plot(track[:, 1], track[:, 0], color=palette.TRUE, linewidth=0.5, alpha=0.35)
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
        palette.dress(axes)
        axes.set_aspect("equal", adjustable="datalim")
        palette.headline(axes, _name(row))
    for axes in panels[len(shown) :]:
        axes.set_visible(False)
    figure.supxlabel("to the right of the heading at entry, m; the box: where the library says that it ends")
    figure.supylabel("ahead, m")
    return figure


def deviations_picture(library: Library, trims: Rows, maneuvers: Rows) -> Figure:
    """Returns histograms of all deviations from the library's values, with its bounds.

    Args:
        library: values and errors.
        trims: by trim, the furthest deviations: forward, side, yaw rate, a row for each flight.
        maneuvers: by maneuver, duration, forward, side, heading change, a row for each performance.
    """
    held = [trim for trim in library.trims if trim.id in trims]
    shown = [row for row in library.maneuvers if row.id in maneuvers][:MOST]
    count = len(held) + len(shown)
    figure = palette.page(17.0, 1.2 + 1.15 * count)
    _title(figure, f"{library.name}: deviations in all flights, and the bounds", shown, library)
    panels = figure.subplots(max(count, 1), 4, squeeze=False)
    for axes, trim in zip(panels, held, strict=False):
        errors = (trim.error.forward, trim.error.side, degrees(trim.error.yaw_rate))
        off = trims[trim.id] * (1, 1, degrees(1))
        for panel, column, error, unit in zip(axes, off.T, errors, ("m/s", "m/s", "deg/s"), strict=False):
            _histogram(panel, column, abs(error), unit)
        axes[0].set_ylabel(f"trim {trim.id}", fontsize=palette.TEXT_SIZE)
        axes[3].set_visible(False)
    for axes, row in zip(panels[len(held) :], shown, strict=False):
        moved, wrong = row.displacement, row.error
        centre = np.array([row.duration, moved.x, moved.y, moved.heading])
        sizes = (wrong.duration, wrong.forward, wrong.side, degrees(wrong.heading_change))
        off = (maneuvers[row.id] - centre) * (1, 1, 1, degrees(1))
        for panel, column, size, unit in zip(axes, off.T, sizes, ("s", "m", "m", "deg"), strict=True):
            _histogram(panel, column, abs(size), unit)
        axes[0].set_ylabel(_name(row), fontsize=palette.TEXT_SIZE)
    for panel, words in zip(panels[0], ("forward speed", "side speed", "yaw rate"), strict=False):
        palette.headline(panel, words)
    if shown:
        names = ("duration", "ahead", "to the right", "heading change")
        for panel, words in zip(panels[len(held)], names, strict=True):
            palette.headline(panel, words)
    return figure


def _histogram(axes: Axes, values: Float[np.ndarray, "n"], bound: float, unit: str) -> None:
    palette.dress(axes)
    reach = 1.15 * max(bound, float(np.abs(values).max(initial=0.0)), 1e-9)
    axes.hist(values, bins=31, range=(-reach, reach), color=palette.TRUE, alpha=0.75)
    for side in (-bound, bound):
        axes.axvline(side, color=palette.ALARM, linewidth=1.4)
    axes.set_xlim(-reach, reach)
    axes.set_yticks([])
    axes.text(0.99, 0.9, unit, ha="right", va="top", fontsize=palette.SMALL_TEXT, transform=axes.transAxes)


def _name(row: Maneuver) -> str:
    return f"{row.id}:  {row.from_trim} \N{RIGHTWARDS ARROW} {row.to_trim}"


def _title(figure: Figure, text: str, shown: Sequence[Maneuver], library: Library) -> None:
    part = (
        ""
        if len(shown) == len(library.maneuvers)
        else f" ({len(shown)} of {len(library.maneuvers)} maneuvers)"
    )
    figure.suptitle(text + part, x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 4, fontweight="bold")
