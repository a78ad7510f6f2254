"""Tests of guarantees: proved claims and unproved statements."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from experiments.mission.stated_time_bound import stated_time_bounds, time_bound_problems, with_time_bound
from experiments.thesis.printed_libraries import thesis_gtmax
from flight.mission.mission import Mission
from flight.plan.plan import Plan, plan_text, read_plan
from flight.se2 import SE2
from maneuver.app import run
from planner.check.guarantees import guarantees_of
from planner.check.plan_check import plan_problems
from planner.commitment.committed import CommittedPlanner
from planner.policies.nominal import nominal_planner
from planner.policies.price_of_robustness import PriceOfRobustness
from planner.policies.worst_case import worst_case_planner
from planner.proof.certify_plan import certify_plan
from scenarios.find import find_library, find_mission
from tests.support.planning.planned_case import case, proved_case
from tests.support.refusal import refusal

Report = dict[str, Any]


def check(
    folder: Path, capsys: pytest.CaptureFixture[str], plan: Plan | Report, *more: str
) -> tuple[int, Report, str]:
    """Returns exit code, JSON output and text of `plan check`."""
    path = folder / "plan.json"
    path.write_text(plan_text(plan) if isinstance(plan, Plan) else json.dumps(plan))
    capsys.readouterr()
    code = run(["plan", "check", str(path), "--json", *more])
    report = json.loads(capsys.readouterr().out)
    assert run(["plan", "check", str(path), *more]) == code
    return code, report, capsys.readouterr().out


@cache
def priced() -> tuple[Plan, Mission]:
    mission = find_mission("gtmax-2")
    return PriceOfRobustness(thesis_gtmax(), 1.05).plan(mission), mission


def test_a_certificate_is_what_makes_a_bound_proved() -> None:
    plan, library, mission = proved_case()
    assert plan_problems(plan, library, mission) == ()
    assert any("no plan of at most 2 trims takes less than" in word for word in guarantees_of(plan).proved)
    assert guarantees_of(plan).unproved == ()
    for status in ("optimal", "feasible"):
        bare = replace(plan, status=status, certificate=None, lower_bound=plan.cost - 1e-9)
        assert plan_problems(bare, library, mission) == ()
        assert not any("takes less" in word for word in guarantees_of(bare).proved)
        assert [
            f"no plan takes less than {plan.cost:.3f} s" in word for word in guarantees_of(bare).unproved
        ] == [True]


def test_proved_and_claimed_are_report_apart_in_text_and_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, report, text = check(tmp_path, capsys, case()[0])
    assert (code, report["passed"], report["problems"]) == (0, True, [])
    assert [word.split(":")[0] for word in report["unproved"]] == ["optimal"]
    assert "valid\n  proved:     the sequence ends" in text
    assert "  not proved: optimal: no plan takes less than" in text


def test_a_bound_of_no_time_is_no_claim() -> None:
    there = Mission("there", SE2.identity(), 2, (0.1, 0.0), 1.0, max_trims=2)
    plan = certify_plan(worst_case_planner(thesis_gtmax(), 1.0).plan(there), thesis_gtmax(), there)
    assert guarantees_of(replace(plan, certificate=None)).unproved == ()
    assert "less than -" not in " ".join(guarantees_of(plan).proved)


@pytest.mark.parametrize("alpha", [1.0, 0.5, 1.01, None])
def test_a_price_that_the_plans_own_scenarios_exceed_fails_its_check(alpha: float | None) -> None:
    plan, mission = priced()
    nominal = next(scenario.cost for scenario in plan.scenarios if scenario.gamma == 0)
    assert plan.cost > 1.02 * nominal
    assert plan_problems(plan, thesis_gtmax(), mission) == ()
    (problem,) = plan_problems(replace(plan, alpha=alpha), thesis_gtmax(), mission)
    assert problem.startswith("alpha: ")


def test_of_a_price_it_is_said_what_a_file_cannot_show() -> None:
    plan, _ = priced()
    about = [sentence.split(":")[0] for sentence in guarantees_of(plan).unproved]
    assert about == ["alpha", "gamma"]
    assert plan.reason.endswith("meets alpha, proved")


def test_a_committed_plan_shows_its_miss_at_every_level() -> None:
    mission = Mission("north", SE2.identity(), 1, (20.0, 0.0), tolerance=3.0, max_trims=2)
    plan = CommittedPlanner(thesis_gtmax(), 0.1).plan(replace(mission, start_trim=3))
    assert plan.found
    assert any("at every gamma from -0.1 to 0.1" in sentence for sentence in guarantees_of(plan).proved)
    still = CommittedPlanner(thesis_gtmax(), 0.0).plan(replace(mission, start_trim=3))
    assert any(sentence.endswith("at gamma 0") for sentence in guarantees_of(still).proved)


@cache
def time_bound_plan(max_trims: int = 4) -> str:
    library, mission = find_library("gtmax-sim"), replace(find_mission("gtmax-2"), max_trims=max_trims)
    planner = nominal_planner(library)
    plan = with_time_bound(
        planner.plan(mission), mission, planner, library, stated_time_bounds("gtmax-sim", library)
    )
    return plan_text(plan)


FORGERIES: dict[str, tuple[Callable[[Report], object], str]] = {
    "a time of its own": (
        lambda plan: plan["time_promise"].update(time=5.0),
        "time_promise.time: expected at least",
    ),
    "another factor": (
        lambda plan: plan["time_promise"].update(factor=1.0),
        "time_promise: expected a time bound of",
    ),
    "another wind": (
        lambda plan: plan["time_promise"].update(wind="severe"),
        "time_promise: expected a time bound of",
    ),
    "another policy's": (
        lambda plan: plan["time_promise"].update(policy="worst-case", gamma=1.0),
        "time_promise: expected a bound for",
    ),
    "not verified": (lambda plan: plan.update(verified=False), "verified: expected True"),
    "no tail": (lambda plan: plan.pop("tail"), "tail: missing"),
    "an alpha": (lambda plan: plan.update(alpha=1.2), "alpha: nominal plans have none"),
    "another library's name": (lambda plan: plan.update(library="mine"), "library: planned with mine"),
}


@pytest.mark.parametrize("name", FORGERIES)
def test_a_forged_plan_fails_its_check(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    forge, words = FORGERIES[name]
    plan = json.loads(time_bound_plan())
    code, report, _ = check(tmp_path, capsys, plan, "--library", "gtmax-sim")
    assert (code, report["problems"]) == (0, [])
    assert any(word.startswith("time bound: 9") for word in report["unproved"])
    forge(plan)
    code, report, _ = check(tmp_path, capsys, plan, "--library", "gtmax-sim")
    assert (code, report["passed"], report["proved"], report["unproved"]) == (1, False, [], [])
    assert any(problem.startswith(words) for problem in report["problems"])


def test_the_signs_of_a_plan_are_not_judged_with_another_library_or_mission(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plan.json"
    path.write_text(plan_text(case()[0]))
    words = refusal(capsys, "plan", "signs", str(path), "--library", "gtmax-sim")
    assert "library: planned with thesis-gtmax, not gtmax-sim" in words
    words = refusal(capsys, "plan", "signs", str(path), "--mission", "gtmax-2")
    assert "mission: planned for gtmax-1, not gtmax-2" in words


def test_the_error_for_a_mission_file_names_the_option(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plan.json"
    path.write_text(plan_text(replace(case()[0], mission="my-own")))
    for verb in ("check", "signs"):
        line = refusal(capsys, "plan", verb, str(path))
        assert "no mission 'my-own'" in line
        assert "give --mission MISSION.toml" in line


def test_a_curve_of_prices_is_report_from_a_plan(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "prices.json"
    pareto = ["plan", "kinematic-1", "--library", "thesis-kinematic", "--pareto"]
    assert run([*pareto, "--out", str(path)]) == 0
    capsys.readouterr()
    line = refusal(capsys, "plan", "check", str(path))
    assert line.endswith("expected maneuver-plan/2 or maneuver-plan/1, got maneuver-prices/1\n")


def test_an_invalid_certificate_names_the_walk() -> None:
    plan, library, mission = proved_case()
    assert plan.certificate is not None
    every = plan.certificate.refutations
    lies = {
        "occurs 2 times": (*every, every[0]),
        "there is no walk (3, 99)": (*every, replace(every[0], sequence=(3, 99))),
        f"covers {len(every) - 1} of {len(every)} walks, not": every[1:],
        "got 'xxx": (replace(every[0], tree="x" * 10_000), *every[1:]),
    }
    for words, refutations in lies.items():
        lie = replace(plan, certificate=replace(plan.certificate, refutations=refutations))
        (problem,) = plan_problems(lie, library, mission)
        assert words in problem
        assert len(problem) < 250


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--pareto --certify", "expected no --certify, got one"),
        ("--pareto --policy committed", "expected no --policy, got one"),
        ("--pareto --gamma 0", "expected no --gamma, got one"),
        ("--pareto --alpha 1.1", "expected no --alpha, got one"),
        ("--alpha 1.1", "--alpha: expected --policy price-of-robustness, got worst-case"),
        ("--gamma 0 --policy nominal", "--gamma: expected --policy worst-case or committed, got nominal"),
        ("--gamma 1 --policy price-of-robustness", "--gamma: expected --policy worst-case or committed, got"),
        ("--deadline 1 --policy price-of-robustness", "--deadline: expected --policy"),
        ("--certify --policy committed", "--certify: expected --policy nominal or worst-case, got committed"),
        ("--alpha inf --policy price-of-robustness", "alpha must be >= 1"),
        ("--max-trims 9", "--max-trims: expected at most 8, got 9"),
    ],
)
def test_an_option_that_would_be_ignored_is_refused(
    options: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert words in refusal(capsys, "plan", "gtmax-2", *options.split())


def test_in_a_narrow_terminal_the_deciding_level_stays_on_one_line(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    assert run(["plan", "gtmax-2"]) == 0
    (line,) = [line for line in capsys.readouterr().out.splitlines() if "decides" in line]
    assert line.split()[0] == "-1"


def test_where_there_is_no_plan_no_walk_is_called_faster() -> None:
    plan, library, mission = proved_case()
    nothing = replace(plan, status="unknown", sequence=(), maneuvers=(), scenarios=())
    assert "may lead to the goal" in certify_plan(nothing, library, mission).reason


@pytest.mark.parametrize("max_trims", [3, 4, 6])
def test_a_valid_time_bound_passes_for_any_longest_sequence(
    max_trims: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code, report, _ = check(tmp_path, capsys, json.loads(time_bound_plan(max_trims)))
    assert (code, report["problems"]) == (0, [])


@pytest.mark.parametrize(
    ("change", "said"),
    [({"miss": 0.1}, "miss: "), ({"policy": "nominal"}, "gamma: nominal plans are for 0")],
)
def test_a_plan_has_no_claims_of_another_policy(change: dict[str, Any], said: str) -> None:
    mission = find_mission("gtmax-2")
    plan = worst_case_planner(thesis_gtmax(), 0.5).plan(mission)
    assert any(
        one.startswith(said) for one in plan_problems(replace(plan, **change), thesis_gtmax(), mission)
    )


def test_a_price_is_never_called_optimal() -> None:
    mission = find_mission("gtmax-2")
    plan = worst_case_planner(thesis_gtmax(), 0.5).plan(mission)
    relabelled = replace(plan, policy="price-of-robustness", alpha=1.5)
    assert any(one.startswith("status: ") for one in plan_problems(relabelled, thesis_gtmax(), mission))


def test_a_time_bound_of_other_plans_is_invalid_without_a_file_beside_the_library(tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text(time_bound_plan())
    plan, library = read_plan(tmp_path / "plan.json"), thesis_gtmax()
    other = replace(plan, policy="worst-case", gamma=0.5)
    (problem,) = time_bound_problems(other, find_mission("gtmax-2"), library, ())
    assert problem.startswith("time_promise: expected a bound for worst-case plans at gamma 0.5")
    assert time_bound_problems(plan, find_mission("gtmax-2"), library, ()) == ()
