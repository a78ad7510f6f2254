"""Tests of the plan check: valid plans pass, broken ones fail."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_kinematic
from flight.plan.plan import Plan, plan_text, read_plan
from flight.se2 import SE2
from maneuver.app import run
from planner.check.plan_check import plan_problems
from tests.support.planning.planned_case import case, proved_case


def with_scenario(plan: Plan, place: int, **changes: object) -> Plan:
    scenarios = list(plan.scenarios)
    scenarios[place] = replace(scenarios[place], **changes)  # type: ignore[arg-type]
    return replace(plan, scenarios=tuple(scenarios))


def later(plan: Plan, place: int, seconds: float) -> Plan:
    """Returns the plan with a longer last coast and matching cost."""
    scenario = plan.scenarios[place]
    times = (*scenario.coasting_times[:-1], scenario.coasting_times[-1] + seconds)
    return with_scenario(plan, place, coasting_times=times, cost=scenario.cost + seconds)


def test_a_good_plan_passes() -> None:
    plan, library, mission = case()
    assert plan_problems(plan, library, mission) == ()


def test_a_plan_passes_after_a_journey_through_a_file(tmp_path: Path) -> None:
    plan, library, mission = case()
    path = tmp_path / "plan.json"
    path.write_text(plan_text(plan))
    assert plan_problems(read_plan(path), library, mission) == ()


BREAKAGES: dict[str, tuple[Callable[[Plan], Plan], str]] = {
    "another library": (lambda plan: replace(plan, library_hash="0" * 64), "library_hash"),
    "another mission": (lambda plan: replace(plan, mission="elsewhere"), "mission"),
    "another tolerance": (lambda plan: replace(plan, tolerance=5.0), "tolerance"),
    "another library's name": (lambda plan: replace(plan, library="elsewhere"), "library: planned with"),
    "no tail": (lambda plan: replace(plan, tail=()), "tail: missing"),
    "a price of another policy": (lambda plan: replace(plan, alpha=1.2), "alpha: worst-case plans have none"),
    "a tail that ends in flight": (lambda plan: replace(plan, tail=plan.tail[:-1] or (3,)), "tail"),
    "a gamma beyond 1": (lambda plan: replace(plan, gamma=1.5), "gamma"),
    "a scenario missing": (lambda plan: replace(plan, scenarios=plan.scenarios[:2]), "scenarios"),
    "a scenario twice": (
        lambda plan: replace(plan, scenarios=(*plan.scenarios, plan.scenarios[0])),
        "scenarios",
    ),
    "a walk that does not exist": (lambda plan: replace(plan, sequence=(2, 7, 3, 7)), "no maneuver"),
    "an unknown trim": (lambda plan: replace(plan, sequence=(2, 9)), "no trim 9"),
    "another start": (lambda plan: replace(plan, sequence=(1, 3, 7, 3)), "starts in trim 2"),
    "other maneuvers": (lambda plan: replace(plan, maneuvers=(1, 2, 3)), "maneuvers"),
    "a negative time": (
        lambda plan: with_scenario(plan, 0, coasting_times=(-1.0, *plan.scenarios[0].coasting_times[1:])),
        ">= 0 s",
    ),
    "a time that is no number": (
        lambda plan: with_scenario(plan, 0, coasting_times=(np.nan, *plan.scenarios[0].coasting_times[1:])),
        ">= 0 s",
    ),
    "a time missing": (
        lambda plan: with_scenario(plan, 0, coasting_times=plan.scenarios[0].coasting_times[1:]),
        "one for each",
    ),
    "a cost too good": (lambda plan: with_scenario(plan, 1, cost=plan.scenarios[1].cost - 1e-6), "cost"),
    "an end elsewhere": (lambda plan: with_scenario(plan, 2, end=SE2(0.0, 0.0, 0.0)), "end"),
    "a time longer": (lambda plan: later(plan, 1, 0.01), "end"),
    "optimal with a bound below the cost": (
        lambda plan: replace(plan, lower_bound=plan.cost - 1e-3),
        "lower_bound",
    ),
    "optimal without a bound": (lambda plan: replace(plan, lower_bound=None), "lower_bound"),
    "a bound above the cost": (lambda plan: replace(plan, lower_bound=plan.cost + 1.0), "lower_bound"),
}


@pytest.mark.parametrize("name", BREAKAGES)
def test_a_broken_plan_is_rejected_with_the_reason(name: str) -> None:
    plan, library, mission = case()
    broken, reason = BREAKAGES[name]
    assert any(reason in problem for problem in plan_problems(broken(plan), library, mission))


def test_a_plan_for_a_nearer_goal_misses_this_one() -> None:
    plan, library, mission = case()
    moved = replace(mission, goal=(mission.goal[0] + 5.0, mission.goal[1]))
    assert any("missed by" in problem for problem in plan_problems(plan, library, moved))


def test_a_plan_is_checked_against_the_numbers_of_the_library() -> None:
    plan, _, mission = case()
    found = plan_problems(replace(plan, library_hash=""), thesis_kinematic(), mission)
    assert any("library_hash" in problem for problem in found)
    assert len(found) > 1


def test_every_small_lie_about_times_is_found() -> None:
    plan, library, mission = case()
    rng = np.random.default_rng(1)
    for _ in range(300):
        place = int(rng.integers(len(plan.scenarios)))
        trim = int(rng.integers(len(plan.sequence)))
        times = list(plan.scenarios[place].coasting_times)
        times[trim] += float(10 ** rng.uniform(-5, 0))
        assert plan_problems(with_scenario(plan, place, coasting_times=tuple(times)), library, mission)


def _turned(leaf: str) -> str:
    """Returns a leaf with reversed multipliers."""
    if ":" not in leaf:
        return leaf
    kappa, numbers = leaf.split(":")
    vector, shares = numbers.split(";")
    north, east = (-float(part) for part in vector.split(","))
    return f"{kappa}:{north:g},{east:g};{shares}"


def broken_proof(plan: Plan, rng: np.random.Generator) -> Plan:
    """Returns the plan with a certificate that proves nothing."""
    certificate = plan.certificate
    assert certificate is not None
    every = list(certificate.refutations)
    place = int(rng.integers(len(every)))
    one = every[place]
    tokens = one.tree.split()
    at = int(rng.integers(len(tokens)))
    leaf = int(rng.choice([k for k, token in enumerate(tokens) if ":" in token]))
    nothing = f"{tokens[leaf][0]}:0,0;{','.join('0' * len(one.sequence))}"
    wrong = (
        replace(one, tree=" ".join(tokens[:at] + tokens[at + 1 :])),
        replace(one, tree=" ".join([*tokens[:leaf], nothing, *tokens[leaf + 1 :]])),
        replace(one, tree=" ".join([*tokens[:leaf], "-", *tokens[leaf + 1 :]])),
        replace(one, tree=one.tree + " -"),
        replace(one, tree=one.tree.replace(":", ";")),
        replace(one, gamma=one.gamma + 0.25),
        replace(one, sequence=(*one.sequence, 9)),
        replace(one, tree=" ".join(_turned(token) for token in tokens)),
        every[place - 1],
        None,
    )
    if rng.random() < 0.1:
        # A proof for shorter walks does not cover longer ones.
        short = tuple(kept for kept in every if len(kept.sequence) < certificate.max_trims)
        return replace(plan, certificate=replace(certificate, max_trims=1, refutations=short))
    lie = wrong[int(rng.integers(len(wrong)))]
    altered = [*every[:place], *([] if lie is None else [lie]), *every[place + 1 :]]
    return replace(plan, certificate=replace(certificate, refutations=tuple(altered)))


def broken(plan: Plan, rng: np.random.Generator) -> Plan:
    """Returns the plan with one fault of at least 1e-5."""
    place, lie = int(rng.integers(3)), float(10 ** rng.uniform(-5, 1)) * float(rng.choice([-1, 1]))
    scenario = plan.scenarios[place]
    trims = list(plan.sequence)
    trims[int(rng.integers(len(trims)))] = int(rng.choice([0, 8, 9]))
    at = int(rng.integers(len(trims)))
    times = tuple(time + lie * (k == at) for k, time in enumerate(scenario.coasting_times))
    end = scenario.end
    text = list(plan.library_hash)
    text[int(rng.integers(len(text)))] = "x"
    lies = (
        with_scenario(plan, place, coasting_times=times),
        with_scenario(plan, place, coasting_times=times, cost=scenario.cost + lie),
        with_scenario(plan, place, cost=scenario.cost + lie),
        with_scenario(plan, place, end=SE2(end.x + lie, end.y, end.heading)),
        with_scenario(plan, place, end=SE2(end.x, end.y, end.heading + lie / 4)),
        with_scenario(plan, place, gamma=scenario.gamma + lie),
        replace(plan, sequence=tuple(trims)),
        replace(plan, sequence=plan.sequence[::-1]),
        replace(plan, library_hash="".join(text)),
        replace(plan, lower_bound=plan.cost + abs(lie)),
        replace(plan, tolerance=plan.tolerance + lie),
        broken_proof(plan, rng),
    )
    return lies[int(rng.integers(len(lies)))]


def test_a_thousand_broken_plans_are_all_rejected() -> None:
    plan, library, mission = proved_case()
    assert plan_problems(plan, library, mission) == ()
    rng = np.random.default_rng(2)
    passed = [
        lie for lie in (broken(plan, rng) for _ in range(1000)) if not plan_problems(lie, library, mission)
    ]
    assert passed == []


def test_three_hundred_broken_proofs_are_all_rejected() -> None:
    plan, library, mission = proved_case()
    rng = np.random.default_rng(3)
    lies = (broken_proof(plan, rng) for _ in range(300))
    assert all(plan_problems(lie, library, mission) for lie in lies)


def test_the_verb_tells_good_from_broken_by_its_exit_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan, _, _ = case()
    good, broken, dearer, torn = (tmp_path / f"{name}.json" for name in ("good", "broken", "dearer", "torn"))
    good.write_text(plan_text(plan))
    broken.write_text(plan_text(later(plan, 1, 0.01)))
    dearer.write_text(plan_text(plan).replace('"cost": ', '"cost": 1', 1))
    torn.write_text(plan_text(plan)[:200])
    assert run(["plan", "check", str(good)]) == 0
    assert run(["plan", "check", str(broken)]) == 1
    assert "invalid" in capsys.readouterr().out
    assert run(["plan", "check", str(dearer)]) == 1
    assert "cost: the deciding scenario" in capsys.readouterr().out
    assert run(["plan", "check", str(torn)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
