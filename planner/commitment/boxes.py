"""Boxes of coasting times, with bounds valid for a whole box.

At the middle of a box the ends at all levels are known with their velocities, and beyond that they stray by
no more than a bound of the second derivatives allows. Any weighted sum of the directions in which levels miss
the goal makes of "within the tolerance at every level" one linear inequality: it cuts the box, bounds the
seconds, and bounds the largest miss from below.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float, Int

from planner.walks.boxes import Boxes

from .committed_task import CommittedTask
from .inequalities import LinearInequalities, least_sum, least_values, tighten_offsets
from .walk_batch import WalkBatch

SLACK = 1e-9
"""Metres, seconds and radians of slack for rounding in every bound."""


AFTER_PULLS = 3
"""Places of the known directions among all, from the last."""


@dataclass(frozen=True, eq=False)
class TimeBoxes(Boxes):
    """Boxes of coasting times in seconds.

    Attributes:
        rows: index of each box's walk.
        turns: full turns with which its times meet the wanted heading; of no meaning where none is wanted.
        seconds: lower bound of the sum of the times in the box.
        miss: lower bound in metres of the largest miss over the box.
        near: largest miss in metres of the middle times at the computed levels.
        widest: the place of the best split.
    """

    rows: Int[np.ndarray, "n"]
    turns: Int[np.ndarray, "n"]
    seconds: Float[np.ndarray, "n"]
    miss: Float[np.ndarray, "n"]
    near: Float[np.ndarray, "n"]
    widest: Int[np.ndarray, "n"]

    @classmethod
    def of(
        cls,
        rows: Int[np.ndarray, "n"],
        turns: Int[np.ndarray, "n"],
        low: Float[np.ndarray, "n trims"],
        high: Float[np.ndarray, "n trims"],
    ) -> "TimeBoxes":
        """Returns boxes without known bounds."""
        nothing = np.zeros(len(rows))
        return cls(low, high, rows, turns, low.sum(axis=1), nothing, nothing, np.zeros(len(rows), dtype=int))


@dataclass(frozen=True, slots=True, eq=False)
class CutDirections:
    """Directions of effective cuts for each walk; 0 for none.

    Attributes:
        position_weights: weighted directions, metres per metre.
        heading_weights: signed weights of the heading at the smallest and the largest gamma, m/rad.
    """

    position_weights: Complex[np.ndarray, "n levels"]
    heading_weights: Float[np.ndarray, "n 2"]


def contract_boxes(
    walk_batch: WalkBatch,
    boxes: TimeBoxes,
    task: CommittedTask,
    known: CutDirections,
    *,
    radius: float,
    budget: Float[np.ndarray, "n"],
) -> TimeBoxes:
    """Returns contracted boxes, without those that hold no feasible times.

    Args:
        walk_batch: the walk of each box, at levels from the smallest to the largest or between them.
        boxes: of times.
        task: the mission over the levels.
        known: cut directions; any are valid.
        radius: metres within which every level must end.
        budget: seconds that the coasting times of each box may take together.
    """
    middle, width = boxes.middle, boxes.width
    end, heading, along = walk_batch.ends(middle)
    off = end - task.goal
    fastest = walk_batch.fastest(along, width, boxes.high)
    bent = _curvature_shares(np.abs(walk_batch.rate), fastest, width)
    stray = bent.sum(axis=2) / 2
    moved = (fastest * width[:, None, :]).sum(axis=2)
    directions = _directions(off, known.position_weights)
    position, here = _position_inequalities(off, along, stray, directions, radius)
    turning = _heading_inequalities(walk_batch, heading, boxes.turns, task)
    both = _combine_with_heading(position, turning, known.heading_weights)
    spare = budget - middle.sum(axis=1)
    every = LinearInequalities(
        np.concatenate([position.slope, both.slope, np.ones((len(spare), 1, width.shape[1]))], axis=1),
        np.concatenate([position.room, both.room, spare[:, None]], axis=1),
    )
    below, above, open_ = tighten_offsets(every, width)
    middle_miss = (np.abs(off) - moved).max(axis=1)
    miss = np.maximum(middle_miss, _least_miss(position, here, directions, below, above))
    seconds = middle.sum(axis=1) + least_sum(every, below, above)
    kept = open_ & (miss <= radius + SLACK) & (seconds <= budget + SLACK)
    influence = bent.max(axis=1) + 0.1 * fastest.max(axis=1) * width
    return TimeBoxes(
        np.maximum(middle + below, 0.0),
        middle + above,
        boxes.rows,
        boxes.turns,
        np.maximum(boxes.seconds, seconds),
        np.maximum(boxes.miss, miss),
        np.abs(off).max(axis=1),
        influence.argmax(axis=1),
    ).take(kept)


def _curvature_shares(
    rate: Float[np.ndarray, "n levels trims"],
    fastest: Float[np.ndarray, "n levels trims"],
    width: Float[np.ndarray, "n trims"],
) -> Float[np.ndarray, "n levels trims"]:
    """Returns each coast's share in twice the linearisation error, in metres."""
    span = width[:, None, :]
    turned = rate * span
    before = np.cumsum(turned, axis=2) - turned
    pushed = fastest * span
    after = np.cumsum(pushed[:, :, ::-1], axis=2)[:, :, ::-1] - pushed
    shares: Float[np.ndarray, "n levels trims"] = pushed * (turned + before) + turned * after
    return shares


def _directions(
    off: Complex[np.ndarray, "n levels"], position_weights: Complex[np.ndarray, "n levels"]
) -> Complex[np.ndarray, "n cuts levels"]:
    """Returns cut directions: of each level, of the walk, between levels."""
    count, levels = off.shape
    own = off / np.maximum(np.abs(off), 1e-300)
    cuts = np.zeros((count, levels + 3, levels), dtype=complex)
    each = np.arange(levels)
    cuts[:, each, each] = own
    cuts[:, levels] = position_weights
    cuts[:, levels + 1] = np.abs(position_weights) * own
    apart = off[:, -1] - off[:, 0]
    apart = apart / np.maximum(np.abs(apart), 1e-300)
    cuts[:, levels + 2, -1], cuts[:, levels + 2, 0] = 0.5 * apart, -0.5 * apart
    return cuts


def _position_inequalities(
    off: Complex[np.ndarray, "n levels"],
    along: Complex[np.ndarray, "n levels trims"],
    stray: Float[np.ndarray, "n levels"],
    directions: Complex[np.ndarray, "n cuts levels"],
    radius: float,
) -> tuple[LinearInequalities, Float[np.ndarray, "n cuts"]]:
    """Returns linearised miss constraints and the miss at the box middle."""
    slope = np.einsum("ncl,nlt->nct", np.conj(directions), along).real
    here = np.einsum("ncl,nl->nc", np.conj(directions), off).real
    weight = np.abs(directions)
    straying = np.einsum("ncl,nl->nc", weight, stray)
    room = radius * weight.sum(axis=2) + straying - here + SLACK
    return LinearInequalities(slope, room), here - straying


def _least_miss(
    position: LinearInequalities,
    here: Float[np.ndarray, "n cuts"],
    directions: Complex[np.ndarray, "n cuts levels"],
    below: Float[np.ndarray, "n trims"],
    above: Float[np.ndarray, "n trims"],
) -> Float[np.ndarray, "n"]:
    """Returns a lower bound of the largest miss over a box."""
    weight = np.abs(directions).sum(axis=2)
    value = (here + least_values(position.slope, below, above)) / np.maximum(weight, 1e-300)
    known: Float[np.ndarray, "n"] = np.where(weight > 1e-12, value, 0.0).max(axis=1)
    return known


def _heading_inequalities(
    walk_batch: WalkBatch,
    heading: Float[np.ndarray, "n levels"],
    turns: Int[np.ndarray, "n"],
    task: CommittedTask,
) -> LinearInequalities:
    """Returns the heading constraints at the outer levels, right then left.

    From one level to the next the heading changes evenly: all levels have it with the same full turns. Then
    follow, likewise, mixtures of both outer levels in which one time after the other is of no matter.
    """
    count, _, trims = walk_batch.rate.shape
    if not task.wants_heading:
        return LinearInequalities(np.zeros((count, 0, trims)), np.zeros((count, 0)))
    left = (heading - task.heading - 2 * np.pi * turns[:, None])[:, [0, -1]]
    low, high = walk_batch.rate[:, 0], walk_batch.rate[:, -1]
    mixed = high[:, :, None] * low[:, None, :] - low[:, :, None] * high[:, None, :]
    apart = high * left[:, :1] - low * left[:, 1:]
    limit = task.heading_tolerance + SLACK
    wide = limit * (np.abs(low) + np.abs(high)) + SLACK
    outer = walk_batch.rate[:, [0, -1]]
    return LinearInequalities(
        np.concatenate([outer, -outer, mixed, -mixed], axis=1),
        np.concatenate([limit - left, limit + left, wide - apart, wide + apart], axis=1),
    )


def _combine_with_heading(
    position: LinearInequalities, turning: LinearInequalities, heading_weights: Float[np.ndarray, "n 2"]
) -> LinearInequalities:
    """Returns the heading constraints, alone and combined with position cuts."""
    if not turning.slope.shape[1]:
        return turning
    place = position.slope.shape[1] - AFTER_PULLS
    slope, room = position.slope[:, place], position.room[:, place]
    for side in (0, 1):
        weight = heading_weights[:, side]
        row = np.arange(len(weight)), np.where(weight > 0, side, 2 + side)
        slope = slope + np.abs(weight)[:, None] * turning.slope[row]
        room = room + np.abs(weight) * turning.room[row]
    return LinearInequalities(
        np.concatenate([turning.slope, slope[:, None]], axis=1),
        np.concatenate([turning.room, room[:, None]], axis=1),
    )
