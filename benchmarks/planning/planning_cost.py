"""Planning cost against depth, trims and levels, as a picture.

Run by `python -m benchmarks.planning.planning_cost FILE 21`.

CPU seconds of the worst-case search, tables warm, over random missions from all start trims: median, and
the slowest. The libraries with more trims are synthetic, by the kinematic equations, seven maneuvers a trim.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import process_time

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from flight.automaton.library import Library
from planner.kernel.exact import ExactSearch
from review.pictures import palette

from .planning_missions import random_mission, shipped_libraries, synthetic_library

DEPTHS = (2, 4, 5, 6, 7, 8)
TRIMS = (10, 20, 40, 70)
LEVELS = (1, 3, 5, 7, 11)
GAMMA = 0.5

Costs = Sequence[tuple[float, float, float]]
"""Varied quantity, median and largest seconds."""


def main(file: Path, missions: int) -> None:
    """Measures, prints and draws."""
    kinematic, gtmax = shipped_libraries()[:2]
    three = (0.0, -GAMMA, GAMMA)
    depth: dict[str, Costs] = {
        one.name: [(d, *cost(one, three, d, missions)) for d in DEPTHS] for one in (kinematic, gtmax)
    }
    trims: dict[str, Costs] = {
        "synthetic, depth 6": [
            (count, *cost(synthetic_library(count, 7 * count, seed=1), three, 6, missions)) for count in TRIMS
        ]
    }
    levels: dict[str, Costs] = {
        f"{one.name}, depth 4": [
            (n, *cost(one, tuple(np.linspace(-1, 1, n) * GAMMA), 4, missions)) for n in LEVELS
        ]
        for one in (kinematic, gtmax)
    }
    panels = {"trims in a sequence": depth, "trims in the library": trims, "levels of gamma": levels}
    figure = palette.new_figure(9.6, 3.6)
    for place, (what, series) in enumerate(panels.items()):
        axes = figure.add_subplot(1, 3, place + 1)
        draw(axes, what, series)
        for name, costs in series.items():
            shown = ", ".join(f"{x:g}: {1e3 * middle:.2f}" for x, middle, _ in costs)
            print(f"{name}, ms by {what}: {shown}")
    figure.axes[0].set_ylabel("CPU time for a plan, ms", fontsize=palette.TEXT_SIZE)
    figure.savefig(file, metadata={"Software": None})


def cost(library: Library, gammas: tuple[float, ...], depth: int, missions: int) -> tuple[float, float]:
    """Returns the median and the largest of CPU seconds over some missions."""
    rng = np.random.default_rng(7)
    search, spent = ExactSearch(library, gammas), []
    for _ in range(missions):
        mission = random_mission(rng, library, depth)
        search.answer(mission, max_nodes=1)
        began = process_time()
        search.answer(mission)
        spent.append(process_time() - began)
    return float(np.median(spent)), float(max(spent))


def draw(axes: Axes, what: str, series: Mapping[str, Costs]) -> None:
    """Draws one panel: medians as lines, maxima as bands."""
    palette.format_axes(axes)
    for (name, costs), colour in zip(series.items(), (palette.TRUE_COLOR, palette.ALARM), strict=False):
        x, middle, most = np.array(costs).T
        axes.plot(x, 1e3 * middle, "o-", color=colour, markersize=3, linewidth=1.4, label=name)
        axes.fill_between(x, 1e3 * middle, 1e3 * most, color=colour, alpha=0.15, linewidth=0)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 3)))
    axes.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel(what, fontsize=palette.TEXT_SIZE)
    axes.legend(frameon=False, fontsize=palette.SMALL_TEXT)


if __name__ == "__main__":
    main(
        Path(sys.argv[1] if len(sys.argv) > 1 else "docs/planning-cost.png"),
        int(sys.argv[2]) if len(sys.argv) > 2 else 21,
    )
