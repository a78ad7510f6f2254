"""Tests of boxes in branch and bound."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from planner.walks.boxes import Boxes, joined


@dataclass(frozen=True, eq=False)
class Named(Boxes):
    """Boxes with a number each."""

    known: Float[np.ndarray, "n"]


def drawn(count: int) -> Named:
    rng = np.random.default_rng(2)
    low = rng.uniform(-1, 1, (count, 3))
    return Named(low, low + rng.uniform(0, 1, (count, 3)), np.arange(float(count)))


def test_two_halves_are_the_whole_and_share_a_face() -> None:
    boxes, place = drawn(5), np.array([0, 1, 2, 1, 0])
    halves = boxes.halves(place)
    lower, upper = halves.take(np.arange(5)), halves.take(np.arange(5, 10))
    assert (lower.low == boxes.low).all()
    assert (upper.high == boxes.high).all()
    at = np.arange(5), place
    assert (lower.high[at] == boxes.middle[at]).all()
    assert (upper.low[at] == boxes.middle[at]).all()
    assert np.allclose(lower.width.prod(axis=1) + upper.width.prod(axis=1), boxes.width.prod(axis=1))
    assert (halves.known == np.tile(boxes.known, 2)).all()


def test_what_is_taken_apart_and_joined_is_the_same() -> None:
    boxes = drawn(6)
    odd = np.arange(6) % 2 == 1
    again = joined(boxes.take(~odd), boxes.take(odd))
    order = np.argsort(again.known)
    for name in ("low", "high", "known"):
        assert (getattr(again.take(order), name) == getattr(boxes, name)).all()
