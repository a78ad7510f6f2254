"""Tests of the reasons of infeasible answers: end and depth."""

from dataclasses import replace
from math import inf, pi
from pathlib import Path
from time import perf_counter

import pytest

from experiments.mission.no_plan import with_full_reason
from experiments.mission.policies import planner_of
from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flight.se2 import SE2
from maneuver.app import run
from planner.policies.infeasibility import fewest_trims, longer_walk, unreachable_end
from planner.walks.walk import walks
from scenarios.find import find_library, find_mission

LIBRARY = find_library("gtmax-sim")
TURN_BACK = Mission("back", SE2.identity(), 3, (30.0, 10.0), 1.0, pi, 0.1, goal_trim=1, max_trims=2)


def answer(mission: Mission, library: Library = LIBRARY, policy: str = "worst-case") -> Plan:
    plan = planner_of(policy, library, gamma=1.0).plan(mission)  # type: ignore[arg-type]
    return with_full_reason(plan, library, mission)


def without_maneuvers_to(trim: int) -> Library:
    return replace(LIBRARY, maneuvers=tuple(one for one in LIBRARY.maneuvers if one.to_trim != trim))


def test_the_shortest_walk_is_the_first_of_all_walks() -> None:
    for start in (trim.id for trim in LIBRARY.trims):
        for goal in (trim.id for trim in LIBRARY.trims):
            first = walks(LIBRARY, start, max_trims=6, goal_trim=goal)[0]
            assert fewest_trims(LIBRARY, start, goal) == len(first)


@pytest.mark.parametrize("policy", ["nominal", "worst-case", "price-of-robustness"])
def test_a_heading_that_walks_cannot_turn_to_is_named_with_the_depth_that_can(policy: str) -> None:
    plan = answer(TURN_BACK, policy=policy)
    assert plan.status == "infeasible"
    cause, _, depth = plan.reason.partition("; ")
    assert cause == "no walk of at most 2 trims from trim 3 ends in trim 1 at heading 180°"
    assert depth == "with 4 trims there is one: --max-trims 4"
    assert answer(replace(TURN_BACK, max_trims=3), policy=policy).status == "infeasible"
    assert answer(replace(TURN_BACK, max_trims=4), policy=policy).found


def test_an_end_is_called_impossible_only_where_no_goal_position_has_a_plan() -> None:
    impossible = 0
    for heading in (0.0, 1.0, pi):
        for depth in (1, 2, 3, 4):
            for goal_trim in (None, 1, 6):
                mission = replace(TURN_BACK, goal_heading=heading, max_trims=depth, goal_trim=goal_trim)
                if unreachable_end(LIBRARY, mission):
                    impossible += 1
                    anywhere = replace(mission, tolerance=1e4)
                    assert not planner_of("nominal", LIBRARY).plan(anywhere).found
    assert impossible > 0


def test_a_last_trim_that_is_too_far_or_never_reached_is_named() -> None:
    here = find_mission("gtmax-2")
    far = max((trim.id for trim in LIBRARY.trims), key=lambda one: fewest_trims(LIBRARY, 2, one) or 0)
    fewest = fewest_trims(LIBRARY, 2, far)
    assert fewest is not None
    plan = answer(replace(here, goal_trim=far, max_trims=fewest - 1))
    assert f"ends in trim {far}; the shortest has {fewest}; with" in plan.reason
    plan = answer(replace(here, goal_trim=6), without_maneuvers_to(6))
    assert plan.reason == "no maneuvers lead from trim 2 to trim 6; nor is there one of at most 8 trims"


def test_the_look_at_longer_walks_ends_in_time() -> None:
    asked: list[float] = []

    def slow(mission: Mission, seconds: float) -> Plan:
        asked.append(seconds)
        until = perf_counter() + seconds
        while perf_counter() < until:
            pass
        return replace(answer(TURN_BACK), status="infeasible")

    began = perf_counter()
    assert longer_walk(TURN_BACK, slow, patience=0.05) == ""
    assert len(asked) == 1
    assert perf_counter() - began < 1.0


def test_an_unproved_result_makes_no_claim_on_longer_walks() -> None:
    unknown = replace(answer(TURN_BACK), status="unknown")
    assert longer_walk(TURN_BACK, lambda _mission, _seconds: unknown, patience=inf) == ""
    assert with_full_reason(unknown, LIBRARY, TURN_BACK) is unknown


def test_a_flight_takes_the_depth_that_its_refusal_names(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "behind.toml"
    path.write_text(
        'name = "behind"\n[start]\nposition = [0.0, 0.0]\nheading = 0.0\ntrim = 2\n'
        "[goal]\nposition = [-5.0, 3.0]\ntolerance = 1.0\n[planner]\nmax_trims = 1\n"
    )
    words = ["fly", "--mission", str(path), "--policy", "nominal", "--ideal-sensors", "--wind", "calm"]
    assert run([*words, "--out", str(tmp_path / "no.mcap")]) == 1
    printed = capsys.readouterr()
    assert "there is one: --max-trims" in printed.err
    depth = printed.err.split("--max-trims ")[1].split()[0]
    run([*words, "--out", str(tmp_path / "yes.mcap"), "--max-trims", depth])
    assert "no plan from the start" not in capsys.readouterr().out


@pytest.mark.parametrize("verb", [("fly", "--mission", "gtmax-2"), ("validate",)])
def test_a_depth_beyond_the_largest_is_refused(
    verb: tuple[str, ...], capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run([*verb, "--max-trims", "9"]) == 2
    assert capsys.readouterr().err == "maneuver: --max-trims: expected at most 8, got 9\n"
    assert not list(tmp_path.iterdir())
