"""Axes of a map: north up, east right, equal scales."""

from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from . import palette


def format_map_axes(axes: Axes) -> None:
    """Formats axes as a map."""
    palette.format_axes(axes)
    axes.set_aspect("equal", adjustable="datalim")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(8, steps=[1, 2, 5, 10]))
    axes.set_xlabel("east, m", fontsize=palette.TEXT_SIZE)
    axes.set_ylabel("north, m", fontsize=palette.TEXT_SIZE)
