"""Tests of the whole chain: fly, identify, plan, fly the plan."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import libraries
import scenarios
from experiments.mission.fly import mission_seed
from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flightlog.attachment_names import MISSION_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.file.reader import read_log
from maneuver.app import run
from maneuver.validate import THESIS_MISSIONS
from scenarios.find import find_campaign
from sim.vehicle.parameters import model_hash

SHIPPED = read_library(libraries.FOLDER / "gtmax-sim.json")
TABLE_10 = read_library(libraries.FOLDER / "thesis-gtmax.json")
SCENARIOS = Path(scenarios.__file__).parent / "campaigns"
STRAIGHT_ROWS = ((2, 1), (1, 2), (1, 3), (3, 1), (3, 2), (2, 3))


@pytest.fixture(scope="module")
def still_air(tmp_path_factory: pytest.TempPathFactory) -> Library:
    """Flies from settled trims, as Table 10's maneuvers begin."""
    folder = tmp_path_factory.mktemp("still")
    shipped = (SCENARIOS / "gtmax.toml").read_text()
    settled = "\n".join(line for line in shipped.splitlines() if not line.startswith("without_coast"))
    campaign, path = folder / "settled.toml", folder / "still-air.json"
    campaign.write_text(settled.replace("coasting_range = [0.0, 8.0]", "coasting_range = [2.0, 8.0]"))
    words = ("--campaign", str(campaign), "--wind", "calm", "--flights", "20", "--seed", "31")
    assert run(("regenerate", *words, "--out", str(path))) == 0
    return read_library(path)


@pytest.mark.parametrize(("left", "reached"), STRAIGHT_ROWS)
def test_in_still_air_the_straight_rows_of_table_10_are_found(
    still_air: Library, left: int, reached: int
) -> None:
    found, printed = still_air.maneuver(left, reached), TABLE_10.maneuver(left, reached)
    assert found.duration == pytest.approx(printed.duration, rel=0.15)
    assert found.displacement.x == pytest.approx(printed.displacement.x, rel=0.08)


def test_every_maneuver_is_flown_equally_often(still_air: Library) -> None:
    counted = [maneuver.statistics for maneuver in still_air.maneuvers]
    assert [entry.samples for entry in counted if entry] == [20] * 22


def test_the_number_of_workers_does_not_show_in_a_library(tmp_path: Path) -> None:
    for workers in ("1", "2"):
        out = tmp_path / workers / "twice.json"
        arguments = ("--flights", "2", "--seed", "8", "--workers", workers, "--out", str(out))
        assert run(("regenerate", *arguments)) == 0
    first, second = (tmp_path / workers / "twice.json" for workers in ("1", "2"))
    assert first.read_bytes() == second.read_bytes()
    assert first.with_suffix(".md").read_bytes() == second.with_suffix(".md").read_bytes()


def test_identification_needs_the_logs_and_no_simulator(tmp_path: Path) -> None:
    logs, once, again = tmp_path / "logs", tmp_path / "a" / "same.json", tmp_path / "b" / "same.json"
    assert run(("fly", "--campaign", "gtmax", "--flights", "2", "--seed", "4", "--out", str(logs))) == 0
    assert run(("identify", str(logs), "--out", str(once))) == 0
    blind = (
        "import sys; sys.modules['sim'] = sys.modules['models'] = None\n"
        "from maneuver.app import run\n"
        f"sys.exit(run(('identify', {str(logs)!r}, '--out', {str(again)!r})))"
    )
    subprocess.run([sys.executable, "-c", blind], check=True, capture_output=True)
    assert once.read_bytes() == again.read_bytes()


def test_the_shipped_library_was_flown_with_the_shipped_vehicle_and_rule() -> None:
    campaign = find_campaign("gtmax")
    assert SHIPPED.provenance["model_hash"] == model_hash()
    assert SHIPPED.conditions.maneuver_end == campaign.rule(campaign.wind)
    ordered = SHIPPED.provenance["campaign"]
    assert len(SHIPPED.provenance["logs_by_seed"]) == ordered["flights"] + ordered.get("nominal", 0)
    assert SHIPPED.provenance["lost"] == []


def test_the_band_of_every_trim_is_wider_than_its_scatter() -> None:
    rule = SHIPPED.conditions.maneuver_end
    assert rule is not None
    for trim in SHIPPED.trims:
        band = rule.bands[trim.id]
        assert abs(trim.error.forward) < band.forward
        assert abs(trim.error.side) < band.side
        assert abs(trim.error.yaw_rate) < band.yaw_rate


def test_validation_does_not_fly_in_the_air_that_the_library_was_found_in() -> None:
    campaign = {int(seed) for seed in SHIPPED.provenance["logs_by_seed"]}
    missions = [mission_seed(1, name, number) for name in THESIS_MISSIONS for number in range(20)]
    assert SHIPPED.provenance["campaign"]["seed"] == 1
    assert len(set(missions)) == len(missions)
    assert campaign.isdisjoint(missions)


def test_a_mission_is_flown_to_its_goal_and_its_log_tells_it(tmp_path: Path) -> None:
    path = tmp_path / "mission.mcap"
    assert run(("fly", "--mission", "gtmax-1", "--seed", "6", "--out", str(path), "--json")) == 0
    log = read_log(path)
    mission = json.loads(log.attachments[MISSION_ATTACHMENT])
    plans = json.loads(log.attachments[PLANS_ATTACHMENT])
    assert mission["policy"] == "worst-case"
    assert plans[0]["time"] == 0.0
    assert all(plan["verified"] for plan in plans if plan["sequence"])
    goal, truth = mission["goal"], log.series["/truth"]
    miss = ((truth["north"] - goal[0]) ** 2 + (truth["east"] - goal[1]) ** 2).min() ** 0.5
    # The track between two samples may be nearer than either, by less than it flies in one.
    assert miss <= mission["tolerance"] + 0.07


def test_the_same_seed_flies_the_same_mission(tmp_path: Path) -> None:
    paths = [tmp_path / name / "mission.mcap" for name in ("a", "b")]
    for path in paths:
        run(("fly", "--mission", "gtmax-2", "--seed", "3", "--out", str(path)))
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_the_scorecard_counts_every_flight(capsys: pytest.CaptureFixture[str]) -> None:
    missions = ("--missions", "gtmax-1", "--flights", "2", "--json")
    code = run(("validate", *missions))
    document = json.loads(capsys.readouterr().out)
    assert [cell["policy"] for cell in document["cells"]] == ["nominal", "worst-case"]
    assert [cell["flights"] for cell in document["cells"]] == [2, 2]
    worst = document["cells"][1]
    assert code == (0 if worst["reached"] == 2 else 1)
    flown = [row for row in document["flights"] if row["policy"] == "worst-case"]
    assert worst["reached"] == sum(row["reached"] for row in flown)
    assert len({row["seed"] for row in flown}) == 2


def test_a_flight_that_runs_out_of_replans_counts_as_not_reached(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Negative control: one replan and one second are insufficient."""
    arguments = ("--missions", "gtmax-1", "--flights", "1", "--max-replans", "1", "--json")
    assert run(("validate", *arguments)) == 1
    cells = json.loads(capsys.readouterr().out)["cells"]
    assert [cell["reached"] for cell in cells] == [0, 0]
    assert all(cell["flown_time"] is None and cell["reasons"] for cell in cells)


def test_the_automaton_reaches_the_goal_without_errors(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = (
        *("--plant", "automaton", "--library", "thesis-kinematic", "--missions", "kinematic-1"),
        *("--tolerance", "0.9144", "--true-gamma", "0", "--flights", "1", "--json"),
    )
    assert run(("validate", *arguments)) == 0
    cells = json.loads(capsys.readouterr().out)["cells"]
    assert [cell["reached"] for cell in cells] == [1, 1]
