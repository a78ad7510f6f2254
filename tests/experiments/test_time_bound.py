"""Tests of the conditions of a plan's time bound."""

from dataclasses import replace
from pathlib import Path

import pytest

from experiments.mission.stated_time_bound import with_time_bound
from flight.plan.time_bound import TimeBound
from flight.se2 import SE2
from maneuver.app import BAD_INPUT, run
from planner.policies.worst_case import worst_case_planner
from scenarios.find import find_library, find_mission

LIBRARY = find_library("gtmax-sim")
MISSION = replace(find_mission("gtmax-2"), tolerance=1.0)
HERE = TimeBound("worst-case", 1.0, "gtmax", 0.9, 2.0, 100, 100, 1)


def bounded(distance: float, *bounds: TimeBound) -> float | None:
    start = MISSION.start
    mission = replace(MISSION, goal=(start.x + distance, start.y), start=SE2(start.x, start.y, 0.3))
    planner = worst_case_planner(LIBRARY, 1.0)
    plan = with_time_bound(planner.plan(mission), mission, planner, LIBRARY, bounds)
    return None if plan.time_promise is None else plan.time_promise.time


def test_a_plans_bound_is_a_multiple_of_its_time_in_the_librarys_wind() -> None:
    time = bounded(30.0, replace(HERE, wind="calm", factor=1.0), HERE)
    assert time == pytest.approx(2.0 * (bounded(30.0, replace(HERE, factor=1.0)) or 0.0))
    assert bounded(30.0, replace(HERE, wind="calm")) is None
    assert bounded(30.0, replace(HERE, policy="nominal")) is None


@pytest.mark.parametrize("distance", [2.0, 65.0])
def test_no_time_is_bounded_outside_the_flown_distances(distance: float) -> None:
    assert bounded(distance, HERE) is None


def test_another_loop_has_no_time_bounds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["validate", "--suite", "random", "--missions", "2", "--calibrate", str(tmp_path / "t.toml")]
    assert run([*words, "--aim", "1"]) == BAD_INPUT
    assert "expected the loop that `plan` promises for" in capsys.readouterr().err
