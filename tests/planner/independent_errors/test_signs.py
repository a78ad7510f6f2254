"""Tests of independent primitive signs (thesis, appendix B)."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.thesis.examples import TABLE_33, simple_example
from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.trim import Trim
from flight.mission.mission import Mission, read_mission
from flight.plan.plan import plan_text
from flight.se2 import SE2, Twist
from maneuver.app import run
from planner.independent_errors.error_path import ErrorGranularity
from planner.independent_errors.independent_errors import (
    TooManyScenariosError,
    bound_independent_errors,
    enumerate_signs,
)
from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from scenarios.find import MISSIONS

AHEAD = """
name = "ahead"

[start]
position = [0.0, 0.0]
heading = 0.0
trim = 1

[goal]
position = [50.0, 0.0]
tolerance = 1.0

[planner]
max_trims = 1
"""


def test_table_33_is_reproduced_but_for_its_misprints() -> None:
    library, mission = simple_example()
    signs = enumerate_signs(library, mission, (1, 2), (0.0, 11.25))
    assert len(signs.scenarios) == 27
    for scenario in signs.scenarios:
        _, change, fast = scenario.signs
        assert scenario.cost == pytest.approx(TABLE_33[change, fast], abs=1e-4)


def test_in_the_simple_example_the_single_gamma_is_the_worst() -> None:
    library, mission = simple_example()
    signs = enumerate_signs(library, mission, (1, 2), (0.0, 11.25))
    assert signs.slowest.cost == pytest.approx(signs.slowest_single.cost)


@pytest.mark.parametrize("name", ["gtmax-1", "gtmax-2"])
def test_a_single_gamma_is_optimistic_through_turns(name: str) -> None:
    library, mission = thesis_gtmax(), read_mission(MISSIONS / f"{name}.toml")
    plan = worst_case_planner(library, 0.5).plan(mission)
    signs = enumerate_signs(library, mission, plan.sequence, plan.coasting_times, gamma=0.5)
    assert len(signs.scenarios) == 3 ** (2 * len(plan.sequence) - 1)
    assert signs.slowest_single.cost == pytest.approx(plan.cost, abs=1e-6)
    assert signs.slowest.cost > plan.cost + 1e-3
    assert signs.furthest.miss >= signs.furthest_single.miss


def test_a_walk_too_long_is_refused() -> None:
    mission = Mission("long", SE2.identity(), 2, (40.0, 0.0))
    with pytest.raises(TooManyScenariosError, match="at most 11 trims and maneuvers"):
        enumerate_signs(thesis_kinematic(), mission, (2, 1) * 4, (0.0,) * 8)


def test_the_verb_shows_the_counter_example(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plan.json"
    mission = read_mission(MISSIONS / "gtmax-2.toml")
    path.write_text(plan_text(worst_case_planner(thesis_gtmax(), 0.5).plan(mission)))
    assert run(["plan", "signs", str(path), "--boxes", "300", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["slowest"]["value"] > found["slowest_single"]["value"]
    assert found["slowest_bound"]["bound"] >= found["slowest"]["value"]
    assert run(["plan", "signs", str(path), "--boxes", "5"]) == 1
    shown = capsys.readouterr().out
    assert "all 2,187 corners" in shown
    assert "no bound" not in shown


def test_errors_that_no_coasting_time_answers_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """2 m drift on 50 m misses the 1 m goal."""
    sliding = Trim(1, "ahead", Twist(5.0, 0.0, 0.0), Twist(0.1, 0.2, 0.0))
    library = Library("sliding", "one straight trim", "", (sliding,), ())
    (tmp_path / "sliding.json").write_text(library_text(library))
    mission = tmp_path / "ahead.toml"
    mission.write_text(AHEAD)
    plan = nominal_planner(library).plan(read_mission(mission))
    (tmp_path / "plan.json").write_text(plan_text(plan))
    words = ["--library", str(tmp_path / "sliding.json"), "--mission", str(mission)]
    assert run(["plan", "signs", str(tmp_path / "plan.json"), *words]) == 0
    shown = capsys.readouterr().out
    assert "no arrival" in shown
    assert "infeasible: with errors trim 1 - the goal is unreachable" in shown
    assert "no bound" not in shown


@pytest.mark.parametrize("each", ["primitive", "scalar"])
def test_who_is_at_the_goal_needs_no_time_whatever_the_errors(each: ErrorGranularity) -> None:
    mission = Mission("here", SE2.identity(), 2, (0.0, 0.0), tolerance=0.0, max_trims=1)
    found = bound_independent_errors(thesis_gtmax(), mission, (2,), (0.0,), gamma=1.0, each=each)
    assert found.slowest_bound.bound == pytest.approx(0.0, abs=1e-6)


def test_what_is_found_in_the_box_is_no_less_than_its_worst_corner() -> None:
    mission = read_mission(MISSIONS / "gtmax-2.toml")
    plan = worst_case_planner(thesis_gtmax(), 0.8).plan(mission)
    for each in ("primitive", "scalar"):
        found = bound_independent_errors(
            thesis_gtmax(), mission, plan.sequence, plan.coasting_times, gamma=0.8, each=each, most_boxes=10
        )
        assert found.furthest.value <= found.furthest_bound.found <= found.furthest_bound.bound
        assert found.slowest.value <= found.slowest_bound.found <= found.slowest_bound.bound


def test_a_plan_that_does_not_keep_its_word_is_not_trusted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mission = read_mission(MISSIONS / "gtmax-2.toml")
    plan = worst_case_planner(thesis_gtmax(), 0.5).plan(mission)
    path = tmp_path / "plan.json"
    path.write_text(plan_text(replace(plan, gamma=0.25)))
    assert run(["plan", "signs", str(path)]) == 2
    assert "invalid plan: scenarios" in capsys.readouterr().err
