"""Check of a certificate: every walk, every box, rounded outward.

Independent of the search and of the certificate's writer: the walks are listed anew, their coefficients taken
from the library as intervals, the boxes cut as in the tree, and each bound evaluated in interval arithmetic.
`docs/planner.md` has the formula; by weak Lagrangian duality it is a lower bound for any multipliers.
"""

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import pairwise
from math import inf, pi

import numpy as np

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.plan.certificate import BoxLeaf, BoxSplit, Certificate, InfeasibilityCertificate, read_tree
from flight.plan.plan import Plan, Scenario
from flight.se2 import SE2

from .certified_bound import Leaves, dual_bound
from .interval_walk import interval_walk, straighten_slow_turns, value_at_gamma
from .intervals import TURN, PoseBox, as_interval, hypot


def certificate_problems(
    certificate: Certificate,
    library: Library,
    mission: Mission,
    *,
    gammas: tuple[float, ...],
    lower_bound: float,
) -> tuple[str, ...]:
    """Returns the faults of a certificate; none if its bound is proved.

    Args:
        certificate: the proof.
        library: the primitives.
        mission: from where to where.
        gammas: levels at which a plan has to reach the goal.
        lower_bound: seconds; infinite if it states that there is no plan.
    """
    if certificate.max_trims != mission.max_trims:
        depth = f"at most {certificate.max_trims} trims, the mission allows {mission.max_trims}"
        return (f"certificate: covers walks of {depth}",)
    listed = Counter(refutation.sequence for refutation in certificate.refutations)
    count, covered = _count_walks(library, mission), _allowed(listed, library, mission)
    if len(covered) < count:
        missing = next(walk for walk in _walks(library, mission) if walk not in covered)
        return (f"certificate: covers {len(covered)} of {count} walks, not {missing}",)
    for walk, times in listed.items():
        if walk not in covered:
            return (f"certificate: there is no walk {walk}",)
        if times > 1:
            return (f"certificate: walk {walk} occurs {times} times, expected once",)
    found = []
    for refutation in certificate.refutations:
        where = f"certificate: walk {refutation.sequence} at gamma {refutation.gamma:g}"
        if refutation.gamma not in gammas:
            found.append(f"{where}: the levels of the plan are {gammas}")
            continue
        try:
            failed = _count_open_leaves(refutation, library, mission, lower_bound)
        except ValueError as error:
            found.append(f"{where}: {error}")
            continue
        if failed:
            found.append(f"{where}: {failed} of its boxes are not refuted")
    return tuple(found)


def _walks(library: Library, mission: Mission) -> Iterator[tuple[int, ...]]:
    """Yields every walk that the mission allows, by trim ids."""
    open_: list[tuple[int, ...]] = [(mission.start_trim,)]
    while open_:
        walk = open_.pop()
        if mission.goal_trim in (None, walk[-1]):
            yield walk
        if len(walk) < mission.max_trims:
            after = sorted(one.to_trim for one in library.maneuvers if one.from_trim == walk[-1])
            open_ += [(*walk, trim) for trim in reversed(after)]


def _count_walks(library: Library, mission: Mission) -> int:
    """Returns how many walks the mission allows, without listing them."""
    ending = Counter({mission.start_trim: 1})
    count = 0
    for _ in range(mission.max_trims):
        count += ending.total() if mission.goal_trim is None else ending[mission.goal_trim]
        longer: Counter[int] = Counter()
        for maneuver in library.maneuvers:
            longer[maneuver.to_trim] += ending[maneuver.from_trim]
        ending = longer
    return count


def _allowed(listed: Iterable[tuple[int, ...]], library: Library, mission: Mission) -> set[tuple[int, ...]]:
    """Returns those of some sequences that are walks which the mission allows."""
    joined = {(maneuver.from_trim, maneuver.to_trim) for maneuver in library.maneuvers}
    return {
        walk
        for walk in listed
        if walk[:1] == (mission.start_trim,)
        and len(walk) <= mission.max_trims
        and mission.goal_trim in (None, walk[-1])
        and all(pair in joined for pair in pairwise(walk))
    }


def _count_open_leaves(
    refutation: InfeasibilityCertificate, library: Library, mission: Mission, lower_bound: float
) -> int:
    """Returns the number of leaves in a tree whose bound fails.

    Raises:
        ValueError: the tree does not cut the whole box into parts.
    """
    walk = interval_walk(library, refutation.sequence, refutation.gamma)
    walk = straighten_slow_turns(walk, mission, lower_bound)
    leaves = _tree_leaves(read_tree(refutation.tree), tuple(place.longest for place in walk.places))
    spare = np.full(len(leaves.low), inf)
    if lower_bound < inf:
        # A coasting time is at most the allowed seconds less the least of the others.
        least = walk.fixed
        for place in range(leaves.low.shape[1]):
            least = least + leaves.low[:, place]
        spare = (as_interval(lower_bound) - least).high
    high = np.minimum(leaves.high, (as_interval(leaves.low) + np.maximum(spare, 0.0)[:, None]).high)
    least_cost = dual_bound(walk, replace(leaves, high=high), mission)
    holds = np.where(leaves.kappa == 1, least_cost >= lower_bound, least_cost > 0) | (spare < 0)
    return int((~holds).sum())


def _tree_leaves(nodes: list[BoxSplit | BoxLeaf], longest: tuple[float, ...]) -> Leaves:
    """Follows a tree from the box of all times to its leaves.

    Raises:
        ValueError: nodes are missing or left over, a cut is outside its box, a leaf lacks numbers.
    """
    trims = len(longest)
    waiting = [((0.0,) * trims, longest)]
    boxes, leaves = [], []
    for node in nodes:
        if not waiting:
            raise ValueError("its tree has nodes left over")
        low, high = waiting.pop()
        if isinstance(node, BoxLeaf):
            if len(node.shares) not in ({trims} if node.kappa is not None else {0}):
                raise ValueError(f"expected {trims} numbers in a leaf, got {len(node.shares)}")
            boxes.append((low, high))
            leaves.append(node)
            continue
        place, time = node.place, node.time
        if not (0 <= place < trims and low[place] <= time <= high[place]):
            raise ValueError(f"a cut at place {place}, {time:g} s, is outside its box")
        waiting.append(((*low[:place], time, *low[place + 1 :]), high))
        waiting.append((low, (*high[:place], time, *high[place + 1 :])))
    if waiting:
        raise ValueError("its tree lacks nodes")
    return Leaves(
        low=np.array([box[0] for box in boxes]),
        high=np.array([box[1] for box in boxes]),
        kappa=np.array([float(leaf.kappa or 0) for leaf in leaves]),
        north=np.array([leaf.vector[0] for leaf in leaves]),
        east=np.array([leaf.vector[1] for leaf in leaves]),
        shares=np.array([leaf.shares or (0.0,) * trims for leaf in leaves]),
    )


def unproved_ends(plan: Plan, library: Library, mission: Mission) -> tuple[str, ...]:
    """Returns the scenarios not proved by interval arithmetic to end at goal."""
    found = []
    for scenario in plan.scenarios:
        try:
            end, heading = _largest_miss(library, plan.sequence, scenario, mission)
        except (ValueError, FlightError):
            # Reported elsewhere: there is no such walk, or no such time.
            continue
        wrong = not end <= mission.destination.reach
        if mission.destination.wants_heading:
            wrong |= not heading <= mission.destination.heading_reach
        if wrong:
            found.append(f"scenario gamma {scenario.gamma:g}: not proved to end at the goal")
    return tuple(found)


def _largest_miss(
    library: Library, sequence: tuple[int, ...], scenario: Scenario, mission: Mission
) -> tuple[float, float]:
    """Returns upper bounds of a scenario's miss: metres and radians."""
    pose = _pose_box(mission.start)
    maneuvers = (None, *library.maneuvers_along(sequence))
    for trim, maneuver, time in zip(sequence, maneuvers, scenario.coasting_times, strict=True):
        if maneuver is not None:
            moved, error = maneuver.displacement, maneuver.error
            pose = pose @ PoseBox(
                value_at_gamma(moved.x, error.forward, scenario.gamma),
                value_at_gamma(moved.y, error.side, scenario.gamma),
                value_at_gamma(moved.heading, error.heading_change, scenario.gamma),
            )
        held, wrong = library.trim(trim).velocity, library.trim(trim).error
        pose = pose @ PoseBox.exp(
            value_at_gamma(held.forward, wrong.forward, scenario.gamma),
            value_at_gamma(held.side, wrong.side, scenario.gamma),
            value_at_gamma(held.yaw_rate, wrong.yaw_rate, scenario.gamma),
            as_interval(time),
        )
    off = pose.heading - (mission.goal_heading or 0.0)
    off = off - TURN * np.round(off.middle / (2 * pi))
    return float(hypot(pose.x - mission.goal[0], pose.y - mission.goal[1]).high), float(off.magnitude)


def _pose_box(pose: SE2) -> PoseBox:
    return PoseBox(as_interval(pose.x), as_interval(pose.y), as_interval(pose.heading))
