"""Tests of the turbulence estimate and adaptive-gamma plans."""

import json
from dataclasses import replace
from math import inf
from pathlib import Path
from statistics import median

import numpy as np
import pytest

from experiments.mission.fly import fly_helicopter, fly_mission
from experiments.mission.mission_task import MissionTask
from flight.automaton.vehicle import Leg
from flight.errors import FlightError
from flight.mission.wind_change import WindChange, parse_wind_change
from flightlog.alarm import ADVICE, AlarmKind
from flightlog.file.reader import read_log
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from flightlog.topics import TRUTH, WIND
from maneuver.app import run
from planner.policies.adaptive_gamma import GAMMAS, AdaptiveGammaPlanner
from scenarios.find import find_library, find_mission
from sim.loop.specification import FlightOptions, FlightSpecification, parse_specification
from sim.simulated_helicopter import SimulatedHelicopter
from sim.supervisor import LIMITS, TURBULENCE_FACTOR, alarm_limits
from sim.wind.turbulence_meter import (
    ERROR_PER_WIND,
    ERROR_PER_WIND_IN_TURNS,
    STILL_AIR_ERROR,
    WARM_UP_TIME,
    TurbulenceMeter,
)
from sim.wind.wind_class import wind_class
from tests.support.commands_flown import replay

LIBRARY = find_library("gtmax-sim")


def flight(wind: str, seed: int, *changes: WindChange, seconds: float = 30.0) -> SimulatedHelicopter:
    """Returns a helicopter after a coast in slow flight."""
    helicopter = SimulatedHelicopter(
        FlightSpecification(seed=seed, start_trim=2, wind=wind, supervised=True, wind_changes=changes),
        LIBRARY,
    )
    for _ in range(round(seconds / 0.5)):
        helicopter.coast(0.5)
    return helicopter


def estimated(helicopter: SimulatedHelicopter) -> float:
    assert helicopter.supervisor is not None
    assert helicopter.supervisor.turbulence is not None
    return helicopter.supervisor.turbulence


def test_the_meter_undoes_what_it_was_made_of() -> None:
    meter = TurbulenceMeter(0.1)
    assert meter.wind_at_20_ft is None
    rng = np.random.default_rng(2)
    size = np.hypot(6.0 * (ERROR_PER_WIND + 0.1**2 * ERROR_PER_WIND_IN_TURNS), STILL_AIR_ERROR)
    for look in range(5000):
        meter.update(float(rng.normal(0.0, size)), yaw_rate=0.1)
        assert (meter.wind_at_20_ft is None) == (0.1 * (look + 1) < WARM_UP_TIME - 1e-9)
    assert meter.wind_at_20_ft == pytest.approx(6.0, rel=0.25)


def test_the_vehicle_can_tell_how_hard_it_blows() -> None:
    """Median of six flights within a third of the wind class."""
    for name in ("gtmax", "light", "9"):
        found = median(estimated(flight(name, seed)) for seed in range(6))
        assert found == pytest.approx(wind_class(name).wind_at_20_ft, rel=1 / 3), name
    assert estimated(flight("calm", 1)) < 1.5


def test_a_wind_that_rises_is_noticed_and_the_flight_before_it_is_the_one_without_it(tmp_path: Path) -> None:
    plain, risen = flight("calm", 4), flight("calm", 4, WindChange(time=10.0, wind="9"))
    assert estimated(plain) < 1.5
    assert estimated(risen) > 6.0
    before, after = plain.log(), risen.log()
    early = before[TRUTH].time < 10.0
    assert (before[TRUTH].values[early] == after[TRUTH].values[early]).all()
    assert np.abs(before[WIND].values[-1] - after[WIND].values[-1]).max() > 0.5
    # The log carries the change, and repeats the flight.
    write_log(after, tmp_path / "risen.mcap")
    again = read_log(tmp_path / "risen.mcap")
    text = again.attachments["specification.json"]
    assert parse_specification(text, "log").wind_changes == (WindChange(time=10.0, wind="9"),)
    assert_repeats(again)
    assert "wind_changes" not in before.attachments["specification.json"].decode()


def assert_repeats(log: FlightLog) -> None:
    flown, truth = replay(log), log[TRUTH]
    rows = np.round(truth.time * 100).astype(int)
    inside = rows < len(flown)
    assert (flown[rows[inside]] == truth.values[inside]).all()


def test_a_wind_fades_into_the_next_without_a_jump() -> None:
    log = flight("gtmax", 5, WindChange(time=3.0, wind="10"), seconds=12.0).log()
    steps = np.abs(np.diff(log[WIND].values[:, :3], axis=0)).max(axis=1)
    early, fading = steps[:300].max(), steps[295:305].max()
    assert fading < 3.0 * early


def test_wind_beyond_the_library_is_said_but_ends_no_mission() -> None:
    limit = alarm_limits(LIBRARY)[AlarmKind.TURBULENCE]
    assert limit == TURBULENCE_FACTOR * wind_class("gtmax").wind_at_20_ft
    unknown = replace(LIBRARY, conditions=replace(LIBRARY.conditions, wind="breeze"))
    assert alarm_limits(unknown)[AlarmKind.TURBULENCE] == LIMITS[AlarmKind.TURBULENCE] == inf
    result = fly_mission(MissionTask(find_mission("gtmax-1"), LIBRARY, "adaptive-gamma", 1.0, "8", 3))
    assert AlarmKind.TURBULENCE in {alarm.kind for alarm in result.alarms}
    assert {alarm.kind for alarm in result.alarms} <= ADVICE
    assert result.reached
    assert result.serious_alarms == ()


def leg(turbulence: float | None) -> Leg:
    return Leg(1.0, settled=True, track=np.zeros((2, 4)), turbulence=turbulence)


def test_the_level_follows_the_turbulence_and_stops_at_the_librarys() -> None:
    planner, mission = AdaptiveGammaPlanner(LIBRARY, 6.0), find_mission("gtmax-2")
    assert planner.gamma == 1.0
    for turbulence, gamma in ((0.1, 0.0), (1.6, 0.25), (3.1, 0.5), (4.4, 0.75), (6.0, 1.0), (20.0, 1.0)):
        planner.learn(leg(turbulence))
        assert planner.gamma == gamma
        assert planner.plan(mission).gamma == gamma
    planner.learn(leg(3.0))
    planner.learn(leg(None))
    assert planner.gamma == 0.5
    assert sorted(GAMMAS) == list(GAMMAS)


def test_an_adaptive_gamma_flight_plans_for_less_in_calm_air_and_for_all_in_the_librarys() -> None:
    def levels(wind: str) -> list[float]:
        task = MissionTask(find_mission("gtmax-1"), LIBRARY, "adaptive-gamma", 1.0, wind, 2)
        _, log = fly_helicopter(task)
        return [plan["gamma"] for plan in json.loads(log.attachments["plans.json"])]

    calm, usual = levels("calm"), levels("gtmax")
    assert calm[0] == usual[0] == 1.0
    assert calm[-1] <= 0.25
    assert median(usual) >= 0.5


@pytest.mark.parametrize("words", ["20", "light 20", "-3 light", "inf light", "nan light", "1 2 3"])
def test_words_that_are_no_change_of_wind_are_refused(words: str) -> None:
    with pytest.raises(FlightError, match="wind change"):
        parse_wind_change(words)


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("--wind-change", "5 storm"), "no wind class 'storm'"),
        (("--wind-change", "soon light"), "expected 'TIME CLASS'"),
        (("--wind-change", "9 light", "--wind-change", "5 calm"), "in order and at least 5 s apart"),
    ],
)
def test_wrong_winds_are_one_line(
    words: tuple[str, ...], problem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(("fly", "--mission", "gtmax-2", *words, "--out", str(tmp_path / "f.mcap"))) == 2
    error = capsys.readouterr().err
    assert problem in error
    assert error.count("\n") == 1
    assert parse_wind_change("20 light") == WindChange(time=20.0, wind="light")
    assert FlightOptions().wind_changes == ()
