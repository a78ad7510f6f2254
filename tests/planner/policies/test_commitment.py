"""Tests of the committed search: worst miss, boxes, worst levels."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.commitment.boxes import CutDirections, TimeBoxes, contract_boxes
from planner.commitment.committed import CommittedPlanner
from planner.commitment.committed_task import CommittedTask
from planner.commitment.walk_batch import walk_batch
from planner.commitment.whole_interval import LinearWalk, worst_miss
from planner.commitment.worst_levels import worst_levels
from planner.walks.walk import walks

FEW = 20_000
"""Boxes; at most a tenth of those for a search with fixed levels."""


def test_the_largest_miss_is_enclosed() -> None:
    library = thesis_gtmax()
    rng = np.random.default_rng(0)
    for _ in range(40):
        choices = walks(library, int(rng.integers(1, 8)), max_trims=4)
        walk = choices[int(rng.integers(len(choices)))]
        times = rng.exponential(4.0, len(walk))
        goal = complex(*rng.normal(0, 10, 2))
        lines = LinearWalk.of(library, walk)
        found = worst_miss(lines, times, goal, 1.0, resolution=1e-6)
        drawn = np.abs(lines.ends(times, rng.uniform(-1, 1, 2000)) - goal).max()
        assert drawn <= found.bound
        assert found.bound - found.found <= 2e-6


@pytest.mark.parametrize("seed", range(4))
def test_no_box_loses_coasting_times_that_are_allowed(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = thesis_gtmax() if seed % 2 else thesis_kinematic()
    none = np.zeros(1, dtype=int)
    for _ in range(150):
        choices = walks(library, int(rng.integers(1, 7)), max_trims=4)
        walk = choices[int(rng.integers(len(choices)))]
        count, gamma = len(walk), float(rng.choice([0.1, 0.5, 1.0]))
        numbers = walk_batch(library, (walk,), (-gamma, 0.0, gamma))
        times = rng.uniform(0, 10, (1, count)) * (rng.random((1, count)) < 0.6)
        end, heading, _ = numbers.ends(times)
        goal = complex(end[0].mean()) + complex(*rng.normal(size=2))
        miss, off = float(np.abs(end[0] - goal).max()), float(np.abs(heading[0] - heading[0].mean()).max())
        task = CommittedTask(
            goal, miss, gamma, bool(off < 3), float(heading[0].mean()) + 2 * pi, off * 1.01 + 1e-3
        )
        size = 10 ** rng.uniform(-2, 1.2)
        low = np.maximum(times - rng.uniform(0, size, (1, count)), 0)
        boxes = TimeBoxes.of(none, none - 1, low, times + rng.uniform(0, size, (1, count)))
        pulls = rng.normal(size=(1, 3)) + 1j * rng.normal(size=(1, 3))
        twists = rng.normal(size=(1, 2)) * (rng.random((1, 2)) < 0.7)
        budget = np.array([times.sum() + 10 ** rng.uniform(-6, 0)])
        left = contract_boxes(
            numbers, boxes, task, CutDirections(pulls, twists), radius=miss * (1 + 1e-9), budget=budget
        )
        assert len(left) == 1
        assert (left.low <= times + 1e-7).all()
        assert (left.high >= times - 1e-7).all()
        assert left.seconds[0] <= times.sum() + 1e-7
        assert left.miss[0] <= miss + 1e-7


def test_boxes_are_looked_at_where_their_middle_misses_most() -> None:
    rng = np.random.default_rng(3)
    grid, library = np.linspace(-1, 1, 17), thesis_gtmax()
    for _ in range(40):
        choices = walks(library, int(rng.integers(1, 8)), max_trims=4)
        lines = LinearWalk.of(library, choices[int(rng.integers(len(choices)))])
        times = rng.exponential(3.0, (lines.rate.shape[1],))
        goal = complex(*rng.normal(0, 10, 2))
        chosen = worst_levels(grid, lines.ends(times, grid)[None, :] - goal, 3)[0]
        assert (np.abs(chosen) <= 1).all()
        looked_at = np.append(chosen, [-1.0, 1.0])
        seen = np.abs(lines.ends(times, looked_at) - goal).max()
        # At most the error of a parabola through three grid points.
        assert seen >= np.abs(lines.ends(times, np.linspace(-1, 1, 2001)) - goal).max() - 0.01


CIRCLING = Mission("circling", SE2.identity(), 5, (20.0, 4.0), tolerance=1.0, max_trims=2)


def test_long_circling_is_excluded_by_the_levels_between_the_ends() -> None:
    plan = CommittedPlanner(thesis_kinematic(), 0.3, max_nodes=FEW).plan(CIRCLING)
    assert "at most 120.0 s" in plan.reason
    assert plan.at_smallest_tolerance is not None
    assert "none below" in plan.at_smallest_tolerance.reason
    assert "stopped" not in plan.at_smallest_tolerance.reason


def test_a_wanted_heading_leaves_few_boxes() -> None:
    goal = (-12.4286, -32.0024)
    start = SE2(6.4463, 3.4126, 1.49428)
    mission = Mission("heading", start, 3, goal, tolerance=1.0, goal_heading=-1.8054, max_trims=3)
    mission = replace(mission, heading_tolerance=0.1)
    plan = CommittedPlanner(thesis_gtmax(), 0.3, max_nodes=FEW).plan(mission)
    assert plan.at_smallest_tolerance is not None
    assert "stopped" not in plan.at_smallest_tolerance.reason


def test_who_ends_in_the_middle_of_his_circle_may_circle_as_long_as_he_likes() -> None:
    # No horizon suffices: the heading varies with gamma, the end does not.
    trims = (
        Trim(1, "turn", Twist(2.0, 0, 0.5), Twist(0.2, 0, 0.05)),
        Trim(2, "hover", Twist(0, 0, 0), Twist(0, 0, 0)),
    )
    inwards = Maneuver(1, 1, 2, 2.0, SE2(0, 4.0, 0), ManeuverError(0, 0, 0, 0))
    lines = LinearWalk.of(Library("middle", "", "", trims, (inwards,)), (1, 2))
    for time in (0.0, 100.0, 10_000.0):
        ends = lines.ends(np.array([time, 0.0]), np.linspace(-1, 1, 101))
        np.testing.assert_allclose(ends, 4j, atol=1e-9)


def test_a_heading_that_errors_smear_is_had_by_no_times() -> None:
    # Only a turn whose rate is uncertain can turn at all; the heading is wanted exactly.
    turn = Trim(1, "turn", Twist(2.0, 0, 0.5), Twist(0, 0, 0.05))
    library = Library("turn", "", "", (turn,), ())
    goal = Mission("turn", SE2.identity(), 1, (4.0, 4.0), tolerance=8.0, goal_heading=1.0, max_trims=1)
    mission = replace(goal, heading_tolerance=0.05)
    plan = CommittedPlanner(library, 1.0).plan(mission)
    assert "at most 120.0 s" in plan.reason
    assert "have the wanted heading" in plan.reason
    assert plan.at_smallest_tolerance is None
