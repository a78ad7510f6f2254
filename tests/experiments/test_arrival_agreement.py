"""Equality of the arrival in flight, log, review, page and index."""

from dataclasses import replace
from math import pi
from pathlib import Path

import pytest

from experiments.mission.fly import fly_and_log
from experiments.mission.mission_task import MissionTask
from flight.mission.fault import parse_fault
from flight.mission.mission import Mission
from flightlog.arrival import judge_log, logged_arrival
from flightlog.attachment_names import ARRIVAL_ATTACHMENT
from flightlog.events import flight_events
from flightlog.file.writer import write_log
from planner.closed_loop.settings import Settings
from review.page.campaign_rows import flight_row
from review.summary.summary import summarise
from review.summary.tiles import summary_tiles
from scenarios.find import find_library, find_mission
from sim.loop.specification import FlightOptions

LIBRARY = find_library("gtmax-sim")
PLAIN = find_mission("gtmax-2")
HOVER = next(trim.id for trim in LIBRARY.trims if trim.velocity.forward == trim.velocity.yaw_rate == 0)


def task(mission: Mission, *, most: int = 60, faults: tuple[str, ...] = ()) -> MissionTask:
    """Returns a nominal flight of a mission in calm air, with a limit of replans."""
    options = FlightOptions(faults=tuple(map(parse_fault, faults)), supervised=bool(faults))
    settings = Settings(max_activations=most)
    return MissionTask(mission, LIBRARY, "nominal", 0.0, "calm", 1, settings=settings, flight_options=options)


CASES = {
    "as it is": task(PLAIN),
    "wanted trim": task(replace(PLAIN, goal_trim=HOVER)),
    "wanted trim, given up": task(replace(PLAIN, goal_trim=HOVER), most=20),
    "wanted heading": task(replace(PLAIN, goal_heading=pi / 2, heading_tolerance=0.2), most=20),
    "given up": task(PLAIN, most=3),
    "alarm": task(PLAIN, faults=("gyro stuck 2 inf",)),
}


@pytest.mark.parametrize("case", CASES)
def test_flight_log_review_and_index_agree(case: str, tmp_path: Path) -> None:
    result, log = fly_and_log(CASES[case])
    assert log is not None
    carried = logged_arrival(log)
    assert carried is not None
    assert carried.reached == result.reached
    kept = {name: text for name, text in log.attachments.items() if name != ARRIVAL_ATTACHMENT}
    without = replace(log, attachments=kept)
    judged = judge_log(without)
    assert judged is not None
    assert (judged.reached, judged.declared, judged.reason) == (
        carried.reached,
        carried.declared,
        carried.reason,
    )
    if carried.time is not None:
        assert judged.time == pytest.approx(carried.time, abs=0.02)
    summary = summarise(log)
    assert summary.arrival == carried
    tile = summary_tiles(summary)[0]
    assert (tile["value"] == "reached") == result.reached
    events = [event.text for event in flight_events(log) if event.source == "goal"]
    assert len(events) == 1
    assert events[0].startswith("goal reached") == result.reached
    path = tmp_path / "flight.mcap"
    write_log(log, path)
    assert (flight_row(path).outcome == "reached") == result.reached
