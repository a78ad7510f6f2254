"""Tests of format versions: old files keep their meaning, newer are refused."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from flight.automaton.library_file import library_hash, read_library
from flight.errors import FlightError
from flight.mission.campaign import read_campaign
from flight.mission.mission import read_mission
from flight.mission.sequence import read_sequence
from flight.plan.plan import read_plan
from flightlog.attachment_names import PLANS_ATTACHMENT
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.identity.fingerprint import fingerprint
from flightlog.log import FlightLog
from flightlog.mission_attachments import logged_plannings, plannings_text
from flightlog.topics import CONVENTIONS
from maneuver.app import run
from sim.vehicle.parameters import read_parameters

GOLDEN = Path(__file__).parents[1] / "golden"
READERS: dict[str, Callable[[Path], object]] = {
    "maneuver-library/1": read_library,
    "maneuver-plan/1": read_plan,
    "maneuver-plan/2": read_plan,
    "maneuver-mission/1": read_mission,
    "maneuver-sequence/1": read_sequence,
    "maneuver-campaign/1": read_campaign,
    "maneuver-vehicle/1": read_parameters,
    "maneuver-flight-log/1": read_log,
}

NEWEST = tuple(schema for schema in READERS if schema != "maneuver-plan/1")


def golden(schema: str) -> Path:
    kind, version = schema.removeprefix("maneuver-").removeprefix("flight-").split("/")
    (path,) = GOLDEN.glob(f"{kind}-{version}.*")
    return path


def test_there_is_a_golden_file_of_every_version_and_no_other() -> None:
    assert {golden(schema) for schema in READERS} == set(GOLDEN.iterdir())


def test_an_old_library_means_what_it_meant() -> None:
    library = read_library(golden("maneuver-library/1"))
    assert library_hash(library) == "b73887e2a3a37d98094a9fca077c8386623b872101f67e1da65ffe7b4fb41680"
    assert [trim.id for trim in library.trims] == [1, 2, 3]
    assert library.maneuver(1, 2).statistics is not None


def test_an_old_plan_means_what_it_meant() -> None:
    plan = read_plan(golden("maneuver-plan/1"))
    assert (plan.status, plan.policy, plan.sequence) == ("optimal", "worst-case", (2, 3, 6, 3))
    assert plan.cost == pytest.approx(16.288610159388423, abs=0)
    assert plan.certificate is not None


def test_an_old_plan_names_its_mission_and_a_newer_one_carries_it() -> None:
    assert read_plan(golden("maneuver-plan/1")).stated_mission is None
    plan = read_plan(golden("maneuver-plan/2"))
    assert (plan.status, plan.policy, plan.sequence) == ("optimal", "worst-case", (2, 5, 2))
    assert plan.cost == pytest.approx(9.609296970905797, abs=0)
    assert plan.stated_mission == read_mission(golden("maneuver-mission/1"))


def test_a_complete_plan_is_checked_with_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["plan", "check", str(golden("maneuver-plan/2"))]) == 0
    assert "valid" in capsys.readouterr().out


def test_the_plans_of_an_old_log_mean_what_they_meant() -> None:
    log = read_log(golden("maneuver-flight-log/1"))
    plans = [planning.plan for planning in logged_plannings(log)]
    assert {plan.schema for plan in plans} == {"maneuver-plan/1"}
    assert plannings_text(logged_plannings(log)) == log.attachments[PLANS_ATTACHMENT]


def test_an_old_mission_sequence_campaign_and_vehicle_mean_what_they_meant() -> None:
    mission = read_mission(golden("maneuver-mission/1"))
    assert (mission.goal, mission.goal_heading, mission.goal_trim) == ((8.0, 5.0), 0.6, 2)
    sequence = read_sequence(golden("maneuver-sequence/1"))
    assert len(sequence.trims) == len(sequence.coasting_times) > 2
    campaign = read_campaign(golden("maneuver-campaign/1"))
    assert (campaign.flights, campaign.nominal_flights) == (153, 30)
    assert campaign.rule("gtmax").bands[6].yaw_rate == 0.160
    assert read_parameters(golden("maneuver-vehicle/1")).name == "gtmax"


def test_an_old_log_means_what_it_meant() -> None:
    log = read_log(golden("maneuver-flight-log/1"))
    assert fingerprint(log) == "06a290006105481139dcfaf5a47f9141bd391c44c81127707339eb6a8ef914d8"
    assert sorted(log.series) == [
        "/command",
        "/controls",
        "/decision",
        "/estimate",
        "/fault",
        "/fault_effect",
        "/navigation",
        "/primitive",
        "/truth",
        "/wind",
    ]
    assert sorted(log.attachments) == [
        "faults.json",
        "initial_state.json",
        "library.json",
        "mission.json",
        "model.xml",
        "plans.json",
        "specification.json",
        "vehicle.json",
    ]


def next_version(schema: str) -> str:
    kind, version = schema.split("/")
    return f"{kind}/{int(version) + 1}"


def newer(schema: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Returns a file of the next version, with an unknown key."""
    path, new = golden(schema), next_version(schema)
    changed = folder / path.name
    match path.suffix:
        case ".mcap":
            log: FlightLog = read_log(path)
            monkeypatch.setitem(CONVENTIONS, "schema", new)
            changed.write_bytes(log_bytes(replace(log)))
        case ".toml":
            text = path.read_text().replace(f'schema = "{schema}"\n', "")
            changed.write_text(f'schema = "{new}"\nof_the_future = 1\n{text}')
        case _:
            text = path.read_text()
            assert schema in text
            changed.write_text(text.replace(schema, new))
    return changed


@pytest.mark.parametrize("schema", NEWEST)
def test_a_newer_version_is_refused_by_name(
    schema: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changed = newer(schema, tmp_path, monkeypatch)
    with pytest.raises(FlightError) as caught:
        READERS[schema](changed)
    assert f"expected {schema}" in str(caught.value)
    assert f"got {next_version(schema)}; another version may read it" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("schema", "words"),
    [
        ("maneuver-library/1", ["library", "check"]),
        ("maneuver-plan/2", ["plan", "check"]),
        ("maneuver-mission/1", ["plan"]),
        ("maneuver-sequence/1", ["fly", "--sequence"]),
        ("maneuver-campaign/1", ["fly", "--campaign"]),
        ("maneuver-flight-log/1", ["review"]),
    ],
)
def test_the_command_line_refuses_a_newer_version_in_one_line(
    schema: str,
    words: list[str],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert run([*words, str(newer(schema, tmp_path, monkeypatch))]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("maneuver: ")
    assert f"expected {schema}" in line


@pytest.mark.parametrize("kind", ["mission", "sequence", "campaign", "vehicle"])
def test_a_file_that_names_its_version_and_one_that_does_not_are_the_same(kind: str, tmp_path: Path) -> None:
    schema = f"maneuver-{kind}/1"
    path = golden(schema)
    bare = path.read_text().replace(f'schema = "{schema}"\n', "")
    (tmp_path / "bare.toml").write_text(bare)
    (tmp_path / "named.toml").write_text(f'schema = "{schema}"\n{bare}')
    read = [READERS[schema](tmp_path / name) for name in ("bare.toml", "named.toml")]
    assert read[0] == read[1] == READERS[schema](path)
