"""One planned time of a mission: in `plan`, `fly`, `validate` and `review`."""

import json
from pathlib import Path

import pytest

from flight.mission.mission import read_mission
from flight.plan.plan import read_plan
from flightlog.attachment_names import MISSION_PLAN_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.file.reader import read_log
from maneuver.app import run
from review.page.comparison import comparison_rows
from review.summary.summary import summarise
from review.summary.tiles import summary_tiles
from scenarios.find import mission_path

GOLDEN = Path(__file__).parents[1] / "golden"


def printed(capsys: pytest.CaptureFixture[str]) -> str:
    return capsys.readouterr().out


@pytest.mark.parametrize("policy", ["nominal", "worst-case"])
def test_a_mission_has_one_planned_time(
    policy: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked, log_path = ["--policy", policy], tmp_path / "flight.mcap"
    run(["plan", "gtmax-2", *asked, "--out", str(tmp_path / "plan.json")])
    plan = read_plan(tmp_path / "plan.json")
    capsys.readouterr()
    run(["fly", "--mission", "gtmax-2", *asked, "--out", str(log_path), "--json"])
    assert json.loads(printed(capsys))["planned_time"] == plan.cost
    run(["review", str(log_path), "--json"])
    assert json.loads(printed(capsys))["planned_time"] == plan.cost
    words = ["--missions", "gtmax-2", "--policies", policy, "--flights", "1", "--plant", "automaton"]
    run(["validate", *words, "--workers", "1", "--json"])
    card = json.loads(printed(capsys))
    assert card["cells"][0]["planned_time"] == card["flights"][0]["planned_time"] == plan.cost
    assert card["flights"][0]["predicted_time"] > plan.cost
    log = read_log(log_path)
    summary, shown = summarise(log), f"{plan.cost:.2f} s"
    assert ("planned time", shown) in {(tile["label"], tile["value"]) for tile in summary_tiles(summary)}
    assert ["planned time", shown] in comparison_rows([summary])
    # The loop's own first plan is another: it has latency, and aims inside the tolerance.
    assert json.loads(log.attachments[PLANS_ATTACHMENT])[0]["tolerance"] < plan.tolerance
    carried = tmp_path / "carried.json"
    carried.write_bytes(log.attachments[MISSION_PLAN_ATTACHMENT])
    assert read_plan(carried).stated_mission == read_mission(mission_path("gtmax-2"))
    assert run(["plan", "check", str(carried)]) == 0


def test_a_log_without_a_planned_time_shows_none() -> None:
    summary = summarise(read_log(GOLDEN / "log-1.mcap"))
    assert summary.planned_time is None
    assert "planned time" not in {tile["label"] for tile in summary_tiles(summary)}
