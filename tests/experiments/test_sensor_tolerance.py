"""Tests of what sensors can tell: missions refused, arrivals claimed."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from experiments.mission.fly import fly_mission
from experiments.mission.mission_task import MissionTask
from experiments.mission.sensor_tolerance import DEVIATIONS, ToleranceTooFineError, check_tolerance
from flight.mission.arrival import claims_arrival
from flight.mission.destination import Destination
from maneuver.app import run
from scenarios.find import find_library, find_mission
from sim.loop.specification import FlightOptions
from sim.navigation.sensor_errors import sensor_classes

LIBRARY = find_library("gtmax-sim")
MISSION = find_mission("gtmax-1")
RTK = sensor_classes()["rtk"]


def task(**changes: object) -> MissionTask:
    sensors = changes.pop("sensors", "rtk")
    mission = replace(MISSION, **changes)  # type: ignore[arg-type]
    options = FlightOptions(sensors=str(sensors), supervised=True)
    return MissionTask(mission, LIBRARY, "worst-case", 1.0, "calm", 1, flight_options=options)


def test_every_shipped_mission_can_be_told_by_the_default_sensors() -> None:
    for name in ("gtmax-1", "gtmax-2", "kinematic-1-flown", "kinematic-2-flown", "kinematic-3-flown"):
        check_tolerance(MissionTask(find_mission(name), LIBRARY, "worst-case", 1.0, "gtmax", 1))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"sensors": "gps"},
            r"expected a tolerance of at least 6.12 m \(4 standard deviations of gps\), got 0.914",
        ),
        ({"tolerance": 0.1}, r"expected a tolerance of at least 0.144 m \(4 standard deviations of rtk\)"),
        (
            {"goal_heading": 1.0, "heading_tolerance": 0.05},
            r"expected a heading_tolerance of at least 0.0866 rad \(4 standard deviations of rtk\), got 0.05",
        ),
    ],
)
def test_a_tolerance_finer_than_the_sensors_is_refused_with_the_one_it_needs(
    changes: dict[str, object], said: str
) -> None:
    with pytest.raises(ToleranceTooFineError, match=f"mission gtmax-1: {said}"):
        fly_mission(task(**changes))


def test_the_tolerance_that_is_asked_for_is_accepted() -> None:
    needed = DEVIATIONS * RTK.position_sigma
    check_tolerance(
        task(tolerance=needed, goal_heading=1.0, heading_tolerance=DEVIATIONS * RTK.heading_sigma)
    )
    with pytest.raises(ToleranceTooFineError):
        check_tolerance(task(tolerance=0.99 * needed))
    ideal = FlightOptions(ideal_navigation=True)
    check_tolerance(replace(task(tolerance=0.01), flight_options=ideal))
    check_tolerance(replace(task(tolerance=0.01), plant="random"))


def test_the_command_line_refuses_before_it_flies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "log.mcap"
    assert run(["fly", "--mission", "gtmax-1", "--sensors", "gps", "--out", str(out)]) == 2
    assert "expected a tolerance of at least 6.12 m" in capsys.readouterr().err
    assert not out.exists()
    assert run(["validate", "--missions", "gtmax-1", "--sensors", "gps", "--flights", "1"]) == 2
    assert "expected a tolerance of at least 6.12 m" in capsys.readouterr().err


@pytest.mark.parametrize("correlated", [False, True])
@pytest.mark.parametrize("heading", [None, 0.0])
@pytest.mark.parametrize("probability", [0.8, 0.9, 0.99])
def test_a_claim_holds_with_its_probability(
    correlated: bool, heading: float | None, probability: float
) -> None:
    """Estimates around the goal with normal errors; of those that claim, the share truly inside."""
    rng = np.random.default_rng(3)
    goal = Destination((0.0, 0.0), 1.0, heading, pi if heading is None else 0.2)
    sigma, heading_sigma = 0.3, 0.06
    inside = claimed = 0
    for offset, turned in zip(np.linspace(0.0, 1.0, 60), np.linspace(0.0, 0.2, 60), strict=True):
        track = np.array([[0.0, offset, 0.0, turned], [1.0, offset, 0.0, turned]])
        claims = claims_arrival(
            track, goal, position_sigma=sigma, heading_sigma=heading_sigma, probability=probability
        )
        if not claims:
            continue
        errors = rng.standard_normal((2000, 2)) / np.sqrt(2.0)
        if correlated:
            errors = np.column_stack([rng.standard_normal(2000), np.zeros(2000)])
        miss = np.hypot(offset + sigma * errors[:, 0], sigma * errors[:, 1])
        true_heading = turned + heading_sigma * rng.standard_normal(2000)
        met = (miss <= 1.0) & ((heading is None) | (np.abs(true_heading) <= 0.2))
        # Five standard errors of a share of 2000.
        assert met.mean() >= probability - 5 * np.sqrt(probability * (1 - probability) / 2000), offset
        claimed, inside = claimed + 2000, inside + int(met.sum())
    assert claimed > 0
    assert inside / claimed >= probability


def test_an_estimate_inside_the_goal_alone_is_no_claim() -> None:
    """Negative control: the margin makes the difference."""
    track = np.array([[0.0, 0.9, 0.0, 0.0], [1.0, 0.9, 0.0, 0.0]])
    goal = Destination((0.0, 0.0), 1.0)
    believe = {"position_sigma": 0.1, "heading_sigma": 0.0}
    assert claims_arrival(track, goal, **believe, probability=0.0)
    assert not claims_arrival(track, goal, **believe, probability=0.99)


def test_exact_estimates_need_no_margin() -> None:
    track = np.array([[0.0, 1.0, 0.0, 0.2], [1.0, 2.0, 0.0, 0.2]])
    goal = Destination((0.0, 0.0), 1.0, 0.0, 0.2)
    assert claims_arrival(track, goal, position_sigma=0.0, heading_sigma=0.0, probability=0.99)
