"""Tests of committed plans against brute force."""

from dataclasses import replace

import numpy as np
import pytest

from flight.automaton.library import Library
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flight.se2 import SE2, Twist
from planner.commitment.committed import CommittedPlanner
from tests.support.studies import committed_proof
from tests.support.studies.committed_proof import Counts, committed_against_brute_force, compare
from tests.support.studies.study import Study

NORTH = Mission("north", SE2.identity(), 1, (20.0, 0.0), tolerance=3.0, max_trims=1)
STRAIGHT = Library("straight", "", "", (Trim(1, "north", Twist(2.0, 0, 0), Twist(0.1, 0, 0)),), ())


class Timid(CommittedPlanner):
    """Planner for half of the tolerance."""

    def plan(self, mission: Mission) -> Plan:
        """Returns a suboptimal plan."""
        return super().plan(replace(mission, tolerance=0.5 * mission.tolerance))


def compared() -> Counts:
    counts = Counts()
    compare(STRAIGHT, NORTH, 1.0, np.random.default_rng(1), counts)
    return counts


def test_brute_force_beats_a_slow_planner_and_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    counts = compared()
    assert counts.statuses == {"optimal": 1}
    assert counts.wrong == 0
    monkeypatch.setattr(committed_proof, "CommittedPlanner", Timid)
    (gap,) = compared().slower
    assert gap == pytest.approx(1.5 / 1.9, abs=1e-3)
    assert compared().wrong > 0


@pytest.mark.slow
def test_study_of_brute_force_against_committed_plans(study: Study) -> None:
    missions = study.size("missions", 20)
    counts = committed_against_brute_force(missions, seed=study.size("seed", 31))
    for line in counts.lines():
        study.show(line)
    assert sum(counts.statuses.values()) == missions
    assert counts.wrong == 0
