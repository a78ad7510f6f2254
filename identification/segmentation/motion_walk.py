"""Walks of flights through the trims, from motion without commands."""

from collections.abc import Sequence
from itertools import permutations

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.errors import FlightError

from .motion_matching import MatchedWalk, MotionModel, TrimGraph
from .motion_model import learn_model, likeliest_walk
from .segmentation import ObservedWalk, TrimEntry


def trim_graph_of(library: Library) -> TrimGraph:
    """Returns the trim graph of a library.

    Raises:
        FlightError: the library has no maneuver-end rule.
    """
    rule = library.conditions.maneuver_end
    if rule is None:
        raise FlightError(
            f"library {library.name!r}: expected conditions.maneuver_end with a band for each trim, dwell, "
            "timeout"
        )
    places = {trim.id: place for place, trim in enumerate(library.trims)}
    bands = [rule.bands[trim.id] for trim in library.trims]
    edges = [(places[row.from_trim], places[row.to_trim]) for row in library.maneuvers]
    return TrimGraph(
        velocity=np.array(
            [(trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate) for trim in library.trims]
        ),
        band=np.array([(band.forward, band.side, band.yaw_rate) for band in bands]),
        edges=np.array(edges, int).reshape(-1, 2),
        dwell=rule.dwell,
    )


def all_edges(trims: int) -> np.ndarray:
    """Returns every ordered pair of different trims, by index."""
    return np.array(list(permutations(range(trims), 2)), int).reshape(-1, 2)


def walks_of(
    motions: Sequence[Float[np.ndarray, "_ 3"]], library: Library, *, model: MotionModel | None = None
) -> tuple[ObservedWalk, ...]:
    """Returns the walk of each flight through a library's trims.

    Args:
        motions: one per flight, from `motion_model.sampled_motion`.
        library: trims, maneuvers and maneuver-end rule; its other numbers are not used.
        model: model of the motion; learnt from the motions where None.
    """
    graph = trim_graph_of(library)
    model = model or learn_model(motions, graph)
    ids = [trim.id for trim in library.trims]
    return tuple(with_trim_ids(likeliest_walk(motion, graph, model), ids) for motion in motions)


def with_trim_ids(walk: MatchedWalk, ids: Sequence[int]) -> ObservedWalk:
    """Replaces the indices of a walk's trims by their ids."""
    return ObservedWalk(
        ids[walk.first], tuple(TrimEntry(step.time, ids[step.left], ids[step.reached]) for step in walk.steps)
    )
