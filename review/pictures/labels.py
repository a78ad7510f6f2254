"""Placement of labels on a map without overlaps."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from flight.se2 import SE2

from . import palette

Points = Float[np.ndarray, "_ 2"]

# Candidate distances of a label from its place, in points of type.
_DISTANCES = (15.0, 24.0, 34.0)
_DIRECTIONS = 16
# Half height and half width of a letter, as shares of the type size; radius of a mark in points.
_HALF_HEIGHT, _HALF_WIDTH = 0.62, 0.3
_MARK = 7.0
# Least ratio of a label's distance to another mark to that to its own; cost of violating it.
_AMBIGUITY_RATIO, _NEARER_TO_ANOTHER = 1.5, 25.0
# Costs of covering a label, a mark, a point of a track; largest number of points counted.
_COVERED_WORD, _COVERED_MARK, _COVERED_TRACK, _MOST_PASSING = 100.0, 40.0, 2.0, 20


@dataclass(frozen=True, slots=True)
class Label:
    """Text of a place and its preferred side.

    Attributes:
        place: the place; the text is preferred at its right, seen along its heading.
        text: the text.
        turned: radians clockwise from the right to the preferred side: pi for the left.
    """

    place: SE2
    text: str
    turned: float = 0.0


def place_labels(axes: Axes, labels: Sequence[Label], drawn: Sequence[Points]) -> None:
    """Places labels on a map that is otherwise complete.

    Args:
        axes: axes of the map.
        labels: labels in order of priority.
        drawn: lines of east and north to keep uncovered.
    """
    if not labels:
        return
    figure = axes.figure.get_figure(root=True)
    assert figure is not None
    # Pixel positions exist only after layout.
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
    """Returns offsets in points, each with its distance from the preferred side."""
    preferred = label.place.heading + pi / 2.0 + label.turned
    longer = _HALF_WIDTH * palette.SMALL_TEXT * len(label.text)
    found = []
    for ring, away in enumerate(_DISTANCES):
        for turn in range(_DIRECTIONS):
            angle = preferred + 2.0 * pi * turn / _DIRECTIONS
            # A text is wider than high, so it stands farther off beside a place than above it.
            reach = away + max(longer - 8.0, 0.0) * abs(sin(angle))
            off = min(turn, _DIRECTIONS - turn) + 3.0 * ring
            found.append((np.array([reach * sin(angle), reach * cos(angle)]), off))
    return found


def _overlap_cost(
    box: Float[np.ndarray, "4"], taken: Sequence[Float[np.ndarray, "4"]], marks: Points, track: Points
) -> float:
    """Returns the cost of the overlaps, in steps of direction."""
    labels = sum(_overlap(box, other) for other in taken)
    covered = _inside(marks, box, margin=_MARK).sum()
    passing = min(_inside(track, box, margin=1.0).sum(), _MOST_PASSING)
    return float(_COVERED_WORD * labels + _COVERED_MARK * covered + _COVERED_TRACK * passing)


def _is_ambiguous(box: Float[np.ndarray, "4"], mark: Float[np.ndarray, "2"], marks: Points) -> bool:
    """Returns True if the text could be read as another mark's."""
    places = np.vstack([mark, marks[(marks != mark).any(axis=1)]])
    away = np.linalg.norm(places - np.clip(places, box[:2], box[2:]), axis=1)
    return bool((away[1:] < _AMBIGUITY_RATIO * away[0]).any())


def _box(middle: Float[np.ndarray, "2"], text: str) -> Float[np.ndarray, "4"]:
    """Returns left, bottom, right and top of a text, in points."""
    half = palette.SMALL_TEXT * np.array([_HALF_WIDTH * len(text), _HALF_HEIGHT])
    return np.concatenate([middle - half, middle + half])


def _overlap(one: Float[np.ndarray, "4"], other: Float[np.ndarray, "4"]) -> bool:
    return bool((one[:2] < other[2:]).all() and (other[:2] < one[2:]).all())


def _inside(points: Points, box: Float[np.ndarray, "4"], *, margin: float) -> np.ndarray:
    return np.asarray(((points > box[:2] - margin) & (points < box[2:] + margin)).all(axis=1))


def _densify(line: Points, axes: Axes) -> Points:
    """Interpolates a line so that overlaps with labels are detected."""
    west, east = axes.get_xlim()
    line = line[np.isfinite(line).all(axis=1)]
    if not len(line):
        return line
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    spaced = np.linspace(0.0, length[-1], max(2, min(4000, int(400 * length[-1] / (east - west)))))
    return np.column_stack([np.interp(spaced, length, column) for column in line.T])
