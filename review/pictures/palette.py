"""Colours and formats of all pictures, distinguishable for the colour-blind."""

from collections.abc import Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

INK = "#222222"
FAINT = "#8a8a8a"
GRID = "#e4e4e4"

TRUE_COLOR = "#0072B2"
ESTIMATE_COLOR = "#E69F00"
ALARM = "#D55E00"
GOAL = "#009E73"

TEXT_SIZE = 9.0
SMALL_TEXT = 7.5


def new_figure(width: float, height: float) -> Figure:
    """Returns an empty figure of a size in inches, without global state."""
    return Figure(figsize=(width, height), dpi=130, layout="constrained", facecolor="white")


def format_axes(axes: Axes) -> None:
    """Formats axes: no box, a faint grid behind the data."""
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(FAINT)
    axes.tick_params(labelsize=SMALL_TEXT + 0.5, colors=INK, length=3, color=FAINT)
    axes.grid(visible=True, color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)


def draw_headline(axes: Axes, text: str) -> None:
    """Writes a panel's title above its left edge."""
    axes.set_title(text, loc="left", fontsize=TEXT_SIZE + 1, color=INK, fontweight="bold")


def draw_legend_above(axes: Axes, entries: Sequence[Artist]) -> None:
    """Draws a legend in one row above a panel's right edge."""
    legend = axes.legend(
        handles=entries,
        loc="lower right",
        bbox_to_anchor=(1.0, 0.99),
        ncols=len(entries),
        frameon=False,
        fontsize=SMALL_TEXT + 0.5,
        borderaxespad=0.0,
        borderpad=0.2,
        columnspacing=1.2,
    )
    # The legend shares the title's row and needs no space of its own.
    legend.set_in_layout(False)


def format_map_axes(axes: Axes) -> None:
    """Formats axes as a map: north up, east right, equal scales."""
    format_axes(axes)
    axes.set_aspect("equal", adjustable="datalim")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(8, steps=[1, 2, 5, 10]))
    axes.set_xlabel("east, m", fontsize=TEXT_SIZE)
    axes.set_ylabel("north, m", fontsize=TEXT_SIZE)
