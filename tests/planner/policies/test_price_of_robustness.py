"""Tests of the price of robustness."""

import json
from math import isclose
from pathlib import Path

import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.mission.mission import read_mission
from flight.plan.plan import plan_text, read_plan
from maneuver.app import run
from planner.check.plan_check import plan_problems
from planner.policies.certified_gamma import certified_gamma
from planner.policies.nominal import nominal_planner
from planner.policies.price_of_robustness import AlphaError, PriceOfRobustness, price_curve
from planner.policies.worst_case import worst_case_planner
from scenarios.find import MISSIONS

LIBRARY = thesis_kinematic()
MISSION = read_mission(MISSIONS / "kinematic-1.toml")


def test_for_the_nominal_time_there_is_no_robustness() -> None:
    plan = PriceOfRobustness(LIBRARY, 1.0).plan(MISSION)
    assert plan.gamma < 1e-5
    assert plan.cost == pytest.approx(nominal_planner(LIBRARY).plan(MISSION).cost, abs=1e-6)


def test_the_alpha_of_a_gamma_gives_that_gamma_and_a_valid_plan() -> None:
    nominal, worst = nominal_planner(LIBRARY).plan(MISSION), worst_case_planner(LIBRARY, 0.5).plan(MISSION)
    plan = PriceOfRobustness(LIBRARY, worst.cost / nominal.cost).plan(MISSION)
    assert plan.gamma == pytest.approx(0.5, abs=1e-5)
    assert plan.cost <= worst.cost + 1e-6
    assert plan_problems(plan, LIBRARY, MISSION) == ()


def test_just_above_the_level_bought_the_price_is_exceeded() -> None:
    plan = PriceOfRobustness(LIBRARY, 1.1).plan(MISSION)
    limit = 1.1 * nominal_planner(LIBRARY).plan(MISSION).cost
    assert plan.cost <= limit + 1e-6 < worst_case_planner(LIBRARY, plan.gamma + 1e-4).plan(MISSION).cost


def test_a_price_that_buys_everything_buys_gamma_1() -> None:
    assert PriceOfRobustness(LIBRARY, 5.0).plan(MISSION).gamma == 1.0


def test_the_curve_begins_at_the_nominal_optimum_and_its_price_never_falls() -> None:
    curve = price_curve(LIBRARY, MISSION, steps=10)
    assert [point.gamma for point in curve] == pytest.approx([step / 10 for step in range(11)])
    assert isclose(curve[0].alpha, 1.0)
    alphas = [point.alpha for point in curve]
    assert alphas == sorted(alphas)
    # Tables 12 to 16 of the thesis, at gamma 0.3, 0.5, 0.8 and 1.
    costs = [curve[place].cost for place in (3, 5, 8, 10)]
    assert costs == pytest.approx([21.070642, 21.934793, 23.342808, 24.369183], abs=1e-4)


def test_a_price_below_1_is_refused() -> None:
    with pytest.raises(AlphaError, match=r"alpha must be >= 1, got 0\.9"):
        PriceOfRobustness(LIBRARY, 0.9)


def test_the_price_travels_in_the_plan_file(tmp_path: Path) -> None:
    plan = PriceOfRobustness(LIBRARY, 1.1).plan(MISSION)
    path = tmp_path / "plan.json"
    path.write_text(plan_text(plan))
    assert read_plan(path) == plan


def test_the_verb_prints_the_curve_and_draws_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / "price.png"
    arguments = ["plan", "kinematic-1", "--library", "thesis-kinematic", "--pareto"]
    assert run([*arguments, "--json", "--picture", str(picture)]) == 0
    points = json.loads(capsys.readouterr().out)["points"]
    assert points[0]["alpha"] == 1.0
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["gtmax-1", "gtmax-2", "kinematic-1", "kinematic-2"])
def test_every_level_below_the_one_bought_is_proved_to_keep_to_the_price(name: str) -> None:
    library = thesis_gtmax() if name.startswith("gtmax") else LIBRARY
    mission = read_mission(MISSIONS / f"{name}.toml")
    plan = PriceOfRobustness(library, 1.1).plan(mission)
    assert "proved" in plan.reason
    limit = 1.1 * nominal_planner(library).plan(mission).cost
    proved = certified_gamma(library, mission, limit=limit + 1e-9, gamma=plan.gamma)
    assert plan.gamma - 1e-3 <= proved <= plan.gamma
    levels = [proved * part / 50 for part in range(51)]
    assert max(worst_case_planner(library, level).plan(mission).cost for level in levels) <= limit + 1e-6


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_no_level_is_proved_beyond_the_first_that_is_too_slow(share: float) -> None:
    mission = read_mission(MISSIONS / "gtmax-1.toml")
    slow, fast = (worst_case_planner(thesis_gtmax(), level).plan(mission).cost for level in (0.6, 0.0))
    limit = fast + share * (slow - fast)
    proved = certified_gamma(thesis_gtmax(), mission, limit=limit, gamma=0.6)
    assert 0 < proved < 0.6
    assert worst_case_planner(thesis_gtmax(), proved).plan(mission).cost <= limit + 1e-9
    assert worst_case_planner(thesis_gtmax(), proved + 1e-3).plan(mission).cost > limit
