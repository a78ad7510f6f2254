"""Words beside places on a map, set where they cover neither one another nor what is drawn."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from flight.se2 import SE2

from . import palette

Points = Float[np.ndarray, "n 2"]

# Points of type: how far words stand from their place, near and where there is no room farther away.
_DISTANCES = (15.0, 24.0, 34.0)
_DIRECTIONS = 16
# Half the height and half the width of a letter, and the room that a mark takes, as shares of the type size.
_HALF_HEIGHT, _HALF_WIDTH = 0.62, 0.3
_MARK = 7.0
# How much farther than its own a label should stand from any other mark, and what it costs not to.
_AMBIGUITY_RATIO, _NEARER_TO_ANOTHER = 1.5, 25.0
# What it costs to cover a word, a mark, a point of a track; points that are counted.
_COVERED_WORD, _COVERED_MARK, _COVERED_TRACK, _MOST_PASSING = 100.0, 40.0, 2.0, 20


@dataclass(frozen=True, slots=True)
class Label:
    """Words for a place.

    Attributes:
        place: where; the words are wanted to its right, seen along its heading.
        text: the words.
        turned: radians clockwise from there to where they are wanted: pi for the left side.
    """

    place: SE2
    text: str
    turned: float = 0.0


def place_labels(axes: Axes, labels: Sequence[Label], drawn: Sequence[Points]) -> None:
    """Writes labels on a map that is otherwise ready, the first of them where it wants to be.

    Args:
        axes: of the map.
        labels: in the order in which they choose their room.
        drawn: lines of east and north that should stay uncovered.
    """
    if not labels:
        return
    figure = axes.figure.get_figure(root=True)
    assert figure is not None
    # Only a figure that was laid out knows where its places are.
    figure.draw_without_rendering()
    points_a_pixel = 72.0 / figure.dpi
    to_points = axes.transData
    marks = points_a_pixel * to_points.transform([(label.place.y, label.place.x) for label in labels])
    lines = [points_a_pixel * to_points.transform(_densify(line, axes)) for line in drawn if len(line)]
    track = np.concatenate(lines) if lines else np.empty((0, 2))
    taken: list[Float[np.ndarray, "4"]] = []
    for label, mark in zip(labels, marks, strict=True):
        offsets = _candidates(label)
        boxes = [_box(mark + offset, label.text) for offset, _ in offsets]
        costs = [
            turned
            + _overlap_cost(box, taken, marks, track)
            + _NEARER_TO_ANOTHER * _is_ambiguous(box, mark, marks)
            for box, (_, turned) in zip(boxes, offsets, strict=True)
        ]
        best = int(np.argmin(costs))
        taken.append(boxes[best])
        axes.annotate(
            label.text,
            (label.place.y, label.place.x),
            xytext=tuple(offsets[best][0]),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=palette.SMALL_TEXT,
            color=palette.INK,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
            zorder=8,
        )


def _candidates(label: Label) -> list[tuple[Float[np.ndarray, "2"], float]]:
    """Returns offsets in points, each with how far it is from what is wanted."""
    wanted = label.place.heading + pi / 2.0 + label.turned
    longer = _HALF_WIDTH * palette.SMALL_TEXT * len(label.text)
    found = []
    for ring, away in enumerate(_DISTANCES):
        for turn in range(_DIRECTIONS):
            angle = wanted + 2.0 * pi * turn / _DIRECTIONS
            # Words are wide: beside a place they stand farther off than above it.
            reach = away + max(longer - 8.0, 0.0) * abs(sin(angle))
            off = min(turn, _DIRECTIONS - turn) + 3.0 * ring
            found.append((np.array([reach * sin(angle), reach * cos(angle)]), off))
    return found


def _overlap_cost(
    box: Float[np.ndarray, "4"], taken: Sequence[Float[np.ndarray, "4"]], marks: Points, track: Points
) -> float:
    """Returns what it costs to write there, in steps turned away from where the words are wanted."""
    words = sum(_overlap(box, other) for other in taken)
    covered = _inside(marks, box, margin=_MARK).sum()
    passing = min(_inside(track, box, margin=1.0).sum(), _MOST_PASSING)
    return float(_COVERED_WORD * words + _COVERED_MARK * covered + _COVERED_TRACK * passing)


def _is_ambiguous(box: Float[np.ndarray, "4"], mark: Float[np.ndarray, "2"], marks: Points) -> bool:
    """Returns whether a reader could take words for those of another mark."""
    places = np.vstack([mark, marks[(marks != mark).any(axis=1)]])
    away = np.linalg.norm(places - np.clip(places, box[:2], box[2:]), axis=1)
    return bool((away[1:] < _AMBIGUITY_RATIO * away[0]).any())


def _box(middle: Float[np.ndarray, "2"], text: str) -> Float[np.ndarray, "4"]:
    """Returns left, bottom, right and top of words around a point, in points of type."""
    half = palette.SMALL_TEXT * np.array([_HALF_WIDTH * len(text), _HALF_HEIGHT])
    return np.concatenate([middle - half, middle + half])


def _overlap(one: Float[np.ndarray, "4"], other: Float[np.ndarray, "4"]) -> bool:
    return bool((one[:2] < other[2:]).all() and (other[:2] < one[2:]).all())


def _inside(points: Points, box: Float[np.ndarray, "4"], *, margin: float) -> np.ndarray:
    return np.asarray(((points > box[:2] - margin) & (points < box[2:] + margin)).all(axis=1))


def _densify(line: Points, axes: Axes) -> Points:
    """Returns a line with points so close together that none of its parts passes under words unseen."""
    west, east = axes.get_xlim()
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    spaced = np.linspace(0.0, way[-1], max(2, min(4000, int(400 * way[-1] / (east - west)))))
    return np.column_stack([np.interp(spaced, way, column) for column in line.T])
