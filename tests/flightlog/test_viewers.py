"""Tests of logs in other programs: layout, Rerun and doctor."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import NonSeekingReader, make_reader

from experiments.mission.fly import fly_helicopter
from experiments.mission.mission_task import MissionTask
from flight.mission.fault import parse_fault
from flight.mission.sequence import Sequence
from flight.se2 import SE2
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import CONTROLS, NAVIGATION, TOPICS, TRUTH
from flightlog.viewers import z_up_frames as z_up
from flightlog.viewers.viewer_channels import VIEWER_TOPICS
from maneuver.app import run
from scenarios.find import find_library, find_mission
from sim.campaign_flight import fly_specification
from sim.loop.specification import FlightOptions, specify_sequence
from tests.support.external_bags import ros2_bag
from tests.support.synthetic_log import synthetic_library, synthetic_log

LAYOUT = Path(__file__).parents[2] / "review" / "viewers" / "foxglove-layout.json"
# Beside the interpreter first: an environment need not be activated to be used.
SEARCHED = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
RERUN, DOCTOR = shutil.which("rerun", path=SEARCHED), shutil.which("pymcap-cli", path=SEARCHED)


def values_of(content: Any, key: str) -> Iterator[Any]:
    """Yields the values of a key anywhere in nested JSON."""
    if isinstance(content, dict):
        if key in content:
            yield content[key]
        content = list(content.values())
    if isinstance(content, list):
        for part in content:
            yield from values_of(part, key)


def test_every_topic_field_and_frame_of_the_layout_is_in_the_contract() -> None:
    layout = json.loads(LAYOUT.read_text(encoding="utf-8"))
    fields = {f"{topic.name}.{field}" for topic in TOPICS for field in topic.field_names}
    shown = [path for path in values_of(layout, "value") if isinstance(path, str)]
    assert len(shown) > 15
    assert set(shown) <= fields
    names = {topic.name for topic in VIEWER_TOPICS}
    assert {*values_of(layout, "topicToRender")} <= names
    (topics,) = values_of(layout, "topics")
    assert set(topics) <= names
    assert {*values_of(layout, "followTf"), *values_of(layout, "frameId")} == {z_up.VEHICLE, z_up.WORLD}
    panels = set(layout["configById"])
    assert {leaf for leaf in _leaves(layout["layout"])} == panels


def _leaves(node: Any) -> Iterator[str]:
    if isinstance(node, str):
        yield node
    else:
        yield from (leaf for side in ("first", "second") for leaf in _leaves(node[side]))


@pytest.fixture(scope="module", params=["sequence", "mission", "fault", "imported", "bare"])
def path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Returns each kind of log on disk."""
    library = find_library("gtmax-sim")
    path = tmp_path_factory.mktemp(request.param) / "flight.mcap"
    log: FlightLog
    if request.param in {"sequence", "fault"}:
        walk = Sequence("short", SE2.identity(), (1, 2), (2.0, 2.0), "gtmax")
        faults = (parse_fault("gps dropout 1 2"),) if request.param == "fault" else ()
        log = fly_specification(
            specify_sequence(walk, seed=1).with_options(FlightOptions(faults=faults)), library
        )
    elif request.param == "imported":
        bag = path.with_name("bag.mcap")
        bag.write_bytes(ros2_bag(synthetic_log(synthetic_library(), (1, 2), (2.0, 2.0), seed=1)[TRUTH]))
        assert run(["import", str(bag), "--pose", "/odom", "--out", str(path)]) == 0
        return path
    elif request.param == "mission":
        mission = find_mission("gtmax-2")
        task = MissionTask(mission, library, policy="nominal", gamma=1.0, wind="calm", seed=1)
        _, log = fly_helicopter(task)
    else:
        whole = synthetic_log(synthetic_library(), (1, 2), (2.0, 2.0), seed=1)
        log = replace(whole, series={TRUTH.name: whole[TRUTH]}, attachments={})
    path.write_bytes(log_bytes(log))
    return path


def topics_in(path: Path) -> set[str]:
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    return {channel.topic for channel in summary.channels.values()}


@pytest.mark.viewer
@pytest.mark.skipif(RERUN is None, reason="no rerun-sdk (half a gigabyte) in this environment")
def test_rerun_finds_no_fault_and_keeps_every_field_of_every_channel(path: Path, tmp_path: Path) -> None:
    check = subprocess.run([str(RERUN), "mcap", "check", path], check=True, capture_output=True, text=True)
    lines = [line.split() for line in check.stdout.splitlines() if "/" in line and "ok" in line.split()[:1]]
    assert {line[3] for line in lines} == topics_in(path)
    converted = tmp_path / "flight.rrd"
    subprocess.run([str(RERUN), "mcap", "convert", path, "-o", converted], check=True, capture_output=True)
    shown = subprocess.run([str(RERUN), "rrd", "print", "-vv", converted], check=True, capture_output=True)
    chunks = shown.stdout.decode().split("entity_path: ")
    held = read_log(path).series
    for topic in TOPICS:
        if topic.name in topics_in(path):
            kept = [chunk for chunk in chunks if chunk.split()[0] == topic.name and "Float64" in chunk]
            assert kept, topic.name
            for field in held[topic.name].topic.field_names:
                assert f'"{field}": non-null Float64' in kept[0], (topic.name, field)


@pytest.mark.viewer
@pytest.mark.skipif(DOCTOR is None, reason="no pymcap-cli in this environment")
def test_an_independent_doctor_finds_no_defect(path: Path) -> None:
    done = subprocess.run([str(DOCTOR), "doctor", path], check=True, capture_output=True, text=True)
    words = " ".join((done.stdout + done.stderr).split())
    # It reports missing attachments as information.
    bare = not read_log(path).attachments
    assert ("passed MCAP doctor checks with 2 info (" if bare else "passed MCAP doctor checks (") in words
    assert not {"warning", "error"} & set(words.lower().split())


def test_messages_of_a_chunk_stand_in_the_order_of_their_times(tmp_path: Path) -> None:
    """Checks increasing times in file order, as the doctor does."""
    log = synthetic_log(synthetic_library(), (1, 2), (8.0, 8.0), seed=1)
    times = log[TRUTH].time
    more = {
        CONTROLS.name: Series(CONTROLS, times + 0.003, log[TRUTH].values[:, :8]),
        NAVIGATION.name: Series(NAVIGATION, times[::5], log[TRUTH].values[::5, :9]),
    }
    path = tmp_path / "flight.mcap"
    path.write_bytes(log_bytes(replace(log, series={**log.series, **more})))
    with path.open("rb") as stream:
        messages = list(NonSeekingReader(stream, validate_crcs=True).iter_messages(log_time_order=False))
    engineering = [
        m.log_time for _, channel, m in messages if not channel.topic.startswith(("/viewer", "/events"))
    ]
    drawn = [m.log_time for _, channel, m in messages if channel.topic.startswith(("/viewer", "/events"))]
    assert len(engineering) > 2000
    assert (np.diff(engineering) >= 0).all()
    assert (np.diff(drawn) >= 0).all()
