"""From the motion of many flights to their walks through the trims: without any command."""

from collections.abc import Sequence
from itertools import permutations

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.errors import FlightError

from .motion_matching import Levels, MatchedWalk, MotionModel
from .motion_model import learnt_model, walk_of
from .segmentation import Entry, Walk


def levels_of(library: Library) -> Levels:
    """Returns the trims and maneuvers of a library as what a motion is matched with.

    Raises:
        FlightError: the library has no maneuver-end rule.
    """
    rule = library.conditions.maneuver_end
    if rule is None:
        raise FlightError(
            f"library {library.name!r} has no conditions.maneuver_end (a band for each trim, dwell, "
            "timeout): nothing says when a trim is reached"
        )
    places = {trim.id: place for place, trim in enumerate(library.trims)}
    bands = [rule.bands[trim.id] for trim in library.trims]
    edges = [(places[row.from_trim], places[row.to_trim]) for row in library.maneuvers]
    return Levels(
        velocity=np.array(
            [(trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate) for trim in library.trims]
        ),
        band=np.array([(band.forward, band.side, band.yaw_rate) for band in bands]),
        edges=np.array(edges, int).reshape(-1, 2),
        dwell=rule.dwell,
    )


def all_edges(trims: int) -> np.ndarray:
    """Returns every ordered pair of different trims, by their places."""
    return np.array(list(permutations(range(trims), 2)), int).reshape(-1, 2)


def walks_of(
    motions: Sequence[Float[np.ndarray, "n 3"]], library: Library, *, model: MotionModel | None = None
) -> tuple[Walk, ...]:
    """Returns the walk of each flight, in the trims of a library.

    Args:
        motions: as `motion_model.sampled_motion` gives them.
        library: trims, maneuvers and maneuver-end rule; its other numbers are not used.
        model: how the vehicle follows its trims; learnt from the motions where None.
    """
    levels = levels_of(library)
    model = model or learnt_model(motions, levels)
    ids = [trim.id for trim in library.trims]
    return tuple(named(walk_of(motion, levels, model), ids) for motion in motions)


def named(walk: MatchedWalk, ids: Sequence[int]) -> Walk:
    """Returns a walk with the ids of the trims for their places."""
    return Walk(
        ids[walk.first], tuple(Entry(step.time, ids[step.left], ids[step.reached]) for step in walk.steps)
    )
