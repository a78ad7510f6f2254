"""Graph of a maneuver automaton: trims as circles, maneuvers as arrows.

Trims are placed by yaw rate and forward speed.
"""

from collections.abc import Sequence
from math import degrees, sqrt

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch

from flight.automaton.library import Library
from flight.automaton.trim import Trim
from flightlog.trim_labels import trim_colors

from . import palette

# Bow of an arrow, as a share of its length; it keeps a maneuver and its reverse apart.
BOW = 0.24
# Position of the number along an arrow: in the middle, or before a trim that the arrow passes.
LABEL, LABEL_BEFORE_A_TRIM = 0.5, 0.13
# Distance from an arrow's chord within which a trim counts as passed.
CLEARANCE = 0.2
# Radius of a trim's circle in points.
RADIUS = 13.0

# Above this number, trims are dots at their true values and arrows carry no numbers.
MANY_TRIMS = 20

Place = tuple[float, float]


def draw_automaton(axes: Axes, library: Library, *, tall: float = 1.6) -> None:
    """Draws the trims and maneuvers of a library.

    Args:
        axes: to draw on.
        library: the automaton.
        tall: height of the graph over half its width.
    """
    if len(library.trims) > MANY_TRIMS:
        _draw_many_trims(axes, library)
        return
    places = _places(library.trims, tall)
    colors = trim_colors(places)
    axes.set_aspect("equal", adjustable="box", anchor="N")
    for maneuver in library.maneuvers:
        ends = places[maneuver.from_trim], places[maneuver.to_trim]
        others = [place for place in places.values() if place not in ends]
        passing = any(_is_between(ends, place) for place in others)
        _arrow(axes, ends, str(maneuver.id), share=LABEL_BEFORE_A_TRIM if passing else LABEL)
    for trim in library.trims:
        x, y = places[trim.id]
        axes.plot(x, y, "o", markersize=2 * RADIUS, color=colors[trim.id], markeredgecolor="white", zorder=4)
        axes.text(x, y, str(trim.id), ha="center", va="center", color="white", fontweight="bold", zorder=5)
        axes.annotate(
            trim.name.replace(" ", "\n", 1),
            (x, y),
            xytext=(0, RADIUS + 4 if y == tall else -RADIUS - 4),
            textcoords="offset points",
            ha="center",
            va="bottom" if y == tall else "top",
            fontsize=palette.TEXT_SIZE,
            linespacing=0.95,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6},
            zorder=6,
        )
    _label_axes(axes, library.trims, places)


def _draw_many_trims(axes: Axes, library: Library) -> None:
    """Draws many trims as dots and their maneuvers as thin curves."""
    places = {trim.id: (degrees(trim.velocity.yaw_rate), trim.velocity.forward) for trim in library.trims}
    for maneuver in library.maneuvers:
        axes.add_artist(
            FancyArrowPatch(
                places[maneuver.from_trim],
                places[maneuver.to_trim],
                connectionstyle=f"arc3,rad={BOW / 2}",
                arrowstyle="-|>",
                mutation_scale=6,
                shrinkA=6,
                shrinkB=6,
                color=palette.TRUE_COLOR,
                linewidth=0.6,
                alpha=0.55,
                zorder=2,
            )
        )
    across, up = zip(*places.values(), strict=True)
    axes.plot(across, up, "o", markersize=11, color=palette.INK, markeredgecolor="white", zorder=4)
    for trim, place in places.items():
        axes.text(*place, str(trim), ha="center", va="center", color="white", fontsize=5.5, zorder=5)
    axes.set_xlabel("yaw rate, deg/s (right turn positive)", fontsize=palette.TEXT_SIZE)
    axes.set_ylabel("forward speed, m/s", fontsize=palette.TEXT_SIZE)
    palette.format_axes(axes)
    axes.margins(0.06)


def _places(trims: Sequence[Trim], tall: float) -> dict[int, Place]:
    """Returns the trims' places.

    Cube roots of the yaw rates separate slow turns from straight flight.
    """
    turning = max(abs(trim.velocity.yaw_rate) for trim in trims) or 1.0
    speeds = [trim.velocity.forward for trim in trims]
    slowest, span = min(speeds), (max(speeds) - min(speeds)) or 1.0
    return {
        trim.id: (
            float(np.cbrt(trim.velocity.yaw_rate / turning)),
            tall * sqrt((trim.velocity.forward - slowest) / span),
        )
        for trim in trims
    }


def _arrow(axes: Axes, ends: tuple[Place, Place], label: str, *, share: float) -> None:
    # As an artist, not a patch: the bow must not widen the axes.
    axes.add_artist(
        FancyArrowPatch(
            *ends,
            connectionstyle=f"arc3,rad={BOW}",
            arrowstyle="-|>",
            mutation_scale=10,
            shrinkA=RADIUS + 1,
            shrinkB=RADIUS + 1,
            color=palette.INK,
            linewidth=1.0,
            alpha=0.8,
            zorder=2,
        )
    )
    (x, y), (along, across) = ends[0], np.subtract(ends[1], ends[0])
    # The arrow is a quadratic curve whose control point is offset from the chord's middle by the bow.
    aside = 2 * share * (1 - share) * BOW
    axes.text(
        x + share * along + aside * across,
        y + share * across - aside * along,
        label,
        ha="center",
        va="center",
        fontsize=palette.SMALL_TEXT,
        color=palette.INK,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
        zorder=7,
    )


def _is_between(ends: tuple[Place, Place], place: Place) -> bool:
    (along, across), (x, y) = np.subtract(ends[1], ends[0]), np.subtract(place, ends[0])
    length = float(np.hypot(along, across)) or 1.0
    aside = abs(along * y - across * x) / length
    return bool(aside < CLEARANCE and 0.0 < (along * x + across * y) / length < length)


def _label_axes(axes: Axes, trims: Sequence[Trim], places: dict[int, Place]) -> None:
    """Labels the axes with the trims' true values."""
    across = {places[trim.id][0]: f"{degrees(trim.velocity.yaw_rate):.3g}" for trim in trims}
    up = {places[trim.id][1]: f"{trim.velocity.forward:.3g}" for trim in trims}
    axes.set_xticks(list(across), list(across.values()))
    axes.set_yticks(list(up), list(up.values()))
    axes.set_xlabel(
        "across: yaw rate, deg/s (right turn positive); up: forward speed, m/s", fontsize=palette.TEXT_SIZE
    )
    palette.format_axes(axes)
    # Room for names and for the widest bow.
    axes.set_xlim(-1.25, 1.25)
    axes.set_ylim(min(up) - 0.36, max(up) + 0.36)
