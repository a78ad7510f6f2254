"""Tests of replay: a flight repeated from its log to the byte."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.mission.repeat import repeat_flight
from flightlog.attachment_names import MISSION_ATTACHMENT, SPECIFICATION_ATTACHMENT, VEHICLE_ATTACHMENT
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes, write_log
from flightlog.identity.log_diff import count_differing_bytes, differences
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ESTIMATE
from maneuver.app import run
from planner.kernel.build import SEARCH_BACKEND
from runtime.version import VERSION
from sim.campaign_flight import fly_specification
from sim.loop.backend import Backend
from sim.loop.specification import parse_specification
from sim.replay import VehicleMismatchError
from sim.vehicle.parameters import change_vehicle, read_parameters
from tests.support.synthetic_log import synthetic_library, synthetic_log

MISSION = ["fly", "--mission", "gtmax-2", "--seed", "3"]
SEQUENCE = ["fly", "--sequence", "slow-walk"]
FLIGHTS = {
    "a mission on the clock, with faults": [
        *(*MISSION, "--latency", "measured"),
        *("--fault", "gps dropout 2 2", "--fault", "controller late 3 2 0.05"),
    ],
    "a mission nominally planned, with ideal sensors": [
        *("fly", "--mission", "gtmax-1", "--policy", "nominal", "--ideal-sensors", "--wind", "light"),
    ],
    "a mission in wind that changes, at the level that is met": [
        *("fly", "--mission", "gtmax-1", "--policy", "adaptive-gamma", "--wind-change", "4 light"),
    ],
    "a sequence without adaptation, with a servo that lags": [
        *(*SEQUENCE, "--no-adaptation", "--fault", "pedal lag 5 5 0.2"),
    ],
}


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("flown")
    paths = {name: folder / f"{number}.mcap" for number, name in enumerate(FLIGHTS)}
    for name, words in FLIGHTS.items():
        assert run([*words, "--out", str(paths[name])]) in {0, 1}
    return paths


@pytest.fixture(scope="module")
def walk(flown: dict[str, Path]) -> FlightLog:
    return read_log(flown["a sequence without adaptation, with a servo that lags"])


def test_flights_of_every_kind_flown_again_from_their_logs_differ_in_no_byte(
    flown: dict[str, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert run(["replay", *map(str, flown.values())]) == 0
    printed = capsys.readouterr().out.splitlines()
    sizes = [path.stat().st_size for path in flown.values()]
    assert printed == [
        f"{path}: 0 of {size} bytes differ" for path, size in zip(flown.values(), sizes, strict=True)
    ]


def test_planning_times_of_the_clock_are_an_input_of_the_flight_flown_again(
    flown: dict[str, Path], tmp_path: Path
) -> None:
    log = read_log(flown["a mission on the clock, with faults"])
    plans = json.loads(log.attachments["plans.json"])
    assert len({plan["latency"] for plan in plans}) > 1
    # The same command with the log's latencies gives the same bytes.
    words = FLIGHTS["a mission on the clock, with faults"]
    again = tmp_path / "again.mcap"
    place = words.index("measured")
    command = [*words[:place], str(flown["a mission on the clock, with faults"]), *words[place + 1 :]]
    run([*command, "--out", str(again)])
    assert log_bytes(read_log(again)) == log_bytes(log)


def test_an_altered_log_differs_from_its_replay(
    walk: FlightLog, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    estimate = walk[ESTIMATE]
    values = estimate.values.copy()
    values[1000:, 0] += 1e-9
    altered = replace(walk, series={**walk.series, ESTIMATE.name: Series(ESTIMATE, estimate.time, values)})
    write_log(altered, tmp_path / "altered.mcap")
    assert run(["replay", str(tmp_path / "altered.mcap"), "--json"]) == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert found["differing"] > 0
    (words,) = found["differences"]
    assert words.startswith(f"/estimate differs from {estimate.time[1000]:.2f} s on, by 1e-09")


def test_a_replay_flies_the_seed_and_the_faults_of_the_log(walk: FlightLog) -> None:
    specification = json.loads(walk.attachments[SPECIFICATION_ATTACHMENT])
    assert specification["faults"]
    other = json.dumps({**specification, "faults": []}).encode()
    without = repeat_flight(replace(walk, attachments={**walk.attachments, SPECIFICATION_ATTACHMENT: other}))
    assert any("/truth differs from 5." in words for words in differences(walk, without))


def test_a_replay_uses_the_back_end_and_the_vehicle_of_the_log(walk: FlightLog) -> None:
    specification = parse_specification(walk.attachments[SPECIFICATION_ATTACHMENT], "log")
    heavy = change_vehicle(read_parameters(), mass=1.1)
    log = fly_specification(specification, walk.library(), parameters=heavy, backend=Backend.INTERPRETED)
    assert log.header.backend.endswith(" interpreted")
    assert log_bytes(repeat_flight(log)) == log_bytes(log)
    assert log.attachments[VEHICLE_ATTACHMENT] != walk.attachments[VEHICLE_ATTACHMENT]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"backend": "casadi-3.8.2 quantum"}, "expected the numeric back-end of the log"),
        ({"backend": "casadi-1.0.0 interpreted"}, "expected the numeric back-end of the log"),
        ({"model_hash": "0" * 64}, "expected the vehicle of the log"),
    ],
)
def test_a_log_of_another_back_end_or_vehicle_is_refused_by_name(
    walk: FlightLog,
    change: dict[str, str],
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "other.mcap"
    write_log(replace(walk, header=replace(walk.header, **change)), path)  # type: ignore[arg-type]
    assert run(["replay", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert next(iter(change.values())) in line


def test_a_mission_planned_by_another_search_is_refused(
    flown: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = read_log(flown["a mission nominally planned, with ideal sensors"])
    here = SEARCH_BACKEND
    assert log.header.search_backend == here
    other = {"compiled": "interpreted", "interpreted": "compiled"}[here]
    write_log(replace(log, header=log.header.with_search_backend(other)), tmp_path / "other.mcap")
    capsys.readouterr()
    assert run(["replay", str(tmp_path / "other.mcap")]) == 2
    assert f"expected the search for plans of the log, {other}, got {here}" in capsys.readouterr().err


def test_a_flight_of_another_code_version_is_replayed_with_a_notice(
    walk: FlightLog, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "other.mcap"
    write_log(replace(walk, header=replace(walk.header, code_version="0.1.0+000000000000")), path)
    assert run(["replay", str(path), "--out", str(tmp_path / "again.mcap")]) == 0
    printed = capsys.readouterr().out
    assert ": 0 of " in printed
    assert f"flown with code 0.1.0+000000000000, repeated with {VERSION}+" in printed
    assert read_log(tmp_path / "again.mcap").header == walk.header


def test_a_log_without_specification_is_not_replayed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = synthetic_log(synthetic_library(), (1, 2), (3.0, 3.0), seed=1)
    write_log(log, tmp_path / "planted.mcap")
    assert run(["replay", str(tmp_path / "planted.mcap")]) == 2
    assert "expected a log of this program's simulator with specification.json" in capsys.readouterr().err


@pytest.mark.parametrize("broken", [b"[]", b"{}", b"no", b'{"policy": "fast", "gamma": 1, "max_nodes": 1}'])
def test_a_broken_mission_in_a_log_is_refused_in_one_line(
    flown: dict[str, Path], broken: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = read_log(flown["a mission nominally planned, with ideal sensors"])
    path = tmp_path / "broken.mcap"
    write_log(replace(log, attachments={**log.attachments, MISSION_ATTACHMENT: broken}), path)
    capsys.readouterr()
    assert run(["replay", str(path)]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_bytes_are_counted_place_by_place() -> None:
    assert count_differing_bytes(b"abc", b"abc") == 0
    assert count_differing_bytes(b"abc", b"abd") == 1
    assert count_differing_bytes(b"abcde", b"xbc") == 3


def test_a_log_of_other_air_of_the_same_name_is_refused(flown: dict[str, Path]) -> None:
    log = read_log(flown["a mission nominally planned, with ideal sensors"])
    assert "mean 10.23 m/s" in log.header.air
    for air, words in (("", "not stated"), ("mean 2.57 m/s", "mean 2.57 m/s")):
        other = replace(log, header=replace(log.header, air=air))
        with pytest.raises(VehicleMismatchError, match=f"expected the air of the log, {words}, got wind at"):
            repeat_flight(other)
