"""Tests of faults in flight and in the log."""

from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from experiments.campaign.fly_campaign import campaign_library
from flight.automaton.library import Library
from flight.errors import FlightError, FlightLostError
from flight.mission.fault import FAULT_KINDS, BadFaultError, Fault, parse_fault
from flightlog.events import flight_events
from flightlog.fault_record import fault_occurrences, logged_faults
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes, write_log
from flightlog.log import FlightLog
from flightlog.topics import CONTROLS, ESTIMATE, FAULT, FAULT_EFFECT, TRUTH, WIND
from maneuver.app import run
from review.summary.summary import summarise
from scenarios.find import find_campaign
from sim.faults.fault_schedule import FaultWindow, fault_window
from sim.loop.specification import FlightOptions, FlightSpecification, NoSensorsError, parse_specification
from sim.simulated_helicopter import SimulatedHelicopter
from sim.vehicle.parameters import read_parameters
from tests.support.commands_flown import replay

LIBRARY: Library = campaign_library(find_campaign("gtmax"), "gtmax")
SERVO_RATE = read_parameters().servos.rate
# Sizes with an effect in the flight below.
SIZES = {
    "gyro bias": "0.01 0 0.01",
    "accelerometer bias": "0.3 0 0",
    "gps bias": "0.3 -0.4 0",
    "magnetometer bias": "0.2",
    "altimeter bias": "1",
    **dict.fromkeys((f"{where} delay" for where, what in FAULT_KINDS if what == "delay"), "0.2"),
    **dict.fromkeys((f"{where} slow" for where, what in FAULT_KINDS if what == "slow"), "0.0005"),
    **dict.fromkeys((f"{where} lag" for where, what in FAULT_KINDS if what == "lag"), "0.3"),
    "controller late": "0.03",
    "controller misses": "4",
    "wind gust": "3 -1 0",
    "vehicle mass": "1.2",
    "vehicle lift": "0.9",
}
EVERY_KIND = [f"{where} {what}" for where, what in FAULT_KINDS]


def fly(*words: str, ideal: bool = False, wind: str = "gtmax") -> FlightLog:
    """Flies 2 s of slow flight and the change to fast flight."""
    faults = tuple(parse_fault(each) for each in words)
    plain = FlightSpecification(seed=3, start_trim=2, wind=wind)
    helicopter = SimulatedHelicopter(
        plain.with_options(FlightOptions(ideal_navigation=ideal, faults=faults)), LIBRARY
    )
    with suppress(FlightLostError):
        helicopter.coast(2.0)
        helicopter.perform(LIBRARY.maneuver(2, 3))
    return helicopter.log()


@cache
def flown(kind: str) -> FlightLog:
    """Flies with a fault from 2.5 s to 3.5 s."""
    return fly(f"{kind} 2.5 1 {SIZES.get(kind, '')}")


@cache
def sound() -> FlightLog:
    return fly()


def effect(log: FlightLog, number: int = 1) -> np.ndarray:
    rows = log[FAULT_EFFECT]
    return np.asarray(rows["effect"][rows["number"] == number])


@pytest.mark.parametrize("kind", EVERY_KIND)
def test_a_fault_acts_in_its_time_and_shows_in_the_log(kind: str) -> None:
    log, fault = flown(kind), parse_fault(f"{kind} 2.5 1 {SIZES.get(kind, '')}")
    assert logged_faults(log) == (fault,)
    assert log[FAULT].time.tolist() == [2.5, 3.5]
    assert log[FAULT]["active"].tolist() == [1.0, 0.0]
    sizes = log[FAULT].values[:, 2:]
    assert np.array_equal(sizes, [[*fault.size, *(0.0,) * (3 - len(fault.size))]] * 2)
    assert log[FAULT_EFFECT].time == pytest.approx(np.arange(250, 350) / 100.0)
    assert np.abs(effect(log)).max() > 0.0
    truth, other = log[TRUTH], sound()[TRUTH]
    rows = min(len(truth), len(other))
    differ = truth.time[:rows][np.any(truth.values[:rows] != other.values[:rows], axis=1)]
    # The same bits until it begins, and a motion of its own soon after.
    assert 2.5 < differ[0] < 2.75


@pytest.mark.parametrize("kind", EVERY_KIND)
def test_a_flight_with_a_fault_is_repeated_to_the_bit(kind: str) -> None:
    log = flown(kind)
    motion, truth = replay(log), log[TRUTH]
    periods = np.round(truth.time * 100.0).astype(int)
    within = periods < len(motion)
    assert within.sum() > 200
    assert np.array_equal(motion[periods[within]], truth.values[within])


def test_a_replay_without_the_fault_is_another_motion() -> None:
    """Negative control of the replay."""
    log = flown("pedal jam")
    specification = parse_specification(log.attachments["specification.json"], "test")
    faultless = specification.with_options(FlightOptions()).to_json()
    with_it, without = (
        replay(replace(log, attachments={**log.attachments, "specification.json": text}))
        for text in (specification.to_json(), faultless)
    )
    assert np.array_equal(with_it[:251], without[:251])
    assert np.abs(with_it[-1, :3] - without[-1, :3]).max() > 1e-3


def test_a_fault_is_an_event_with_its_sizes_and_effect() -> None:
    texts = [event.text for event in flight_events(flown("gps bias")) if event.source == "fault"]
    assert texts == [
        "fault 1: gps bias (0.3 m -0.4 m 0 m) until 3.50 s; "
        "how far the reading is from that of the sound gps: 0.5 m"
    ]
    assert summarise(flown("gps bias")).faults == (f"2.50 s: {texts[0].removeprefix('fault 1: ')}",)
    assert summarise(sound()).faults == ()
    assert not [event for event in flight_events(sound()) if event.source == "fault"]


def test_a_log_without_the_fault_that_began_is_refused() -> None:
    log = flown("gps bias")
    with pytest.raises(FlightError, match=r"faults.json: expected fault 1, got 0 faults"):
        fault_occurrences(replace(log, attachments={**log.attachments, "faults.json": b"[]"}))


def test_without_a_fault_its_topics_are_absent() -> None:
    assert FAULT.name not in sound().series
    assert FAULT_EFFECT.name not in sound().series
    assert logged_faults(sound()) == ()


def test_a_fault_that_changes_nothing_has_no_effect() -> None:
    """Negative control of the effects: faults without change."""
    log = fly("lateral slow 2 1 1", "vehicle mass 2 1 1", "wind gust 2 1 0 0 0", "gyro bias 2 1 0 0 0")
    assert not log[FAULT_EFFECT]["effect"].any()
    assert np.array_equal(log[TRUTH].values, sound()[TRUTH].values)


def test_a_jammed_servo_stays_and_then_goes_on() -> None:
    log = flown("longitudinal jam")
    servo, time = log[CONTROLS]["longitudinal"], log[CONTROLS].time
    inside = (time > 2.505) & (time < 3.505)
    assert np.ptp(servo[inside]) == 0.0
    assert np.ptp(log[CONTROLS]["longitudinal_command"][inside]) > 0.0
    assert np.ptp(servo[time > 3.51]) > 0.0


def test_a_slow_servo_keeps_within_its_rate() -> None:
    log = flown("lateral slow")
    time, servo = log[CONTROLS].time, log[CONTROLS]["lateral"]
    steps = np.abs(np.diff(servo))[(time[1:] > 2.505) & (time[1:] < 3.505)]
    assert steps.max() == pytest.approx(0.0005 * SERVO_RATE * 0.01, rel=1e-9)


def test_a_late_command_is_one_from_before() -> None:
    late, plain = flown("controller late")[CONTROLS], sound()[CONTROLS]
    first = int(np.searchsorted(late.time, 2.5 - 1e-9))
    # The last command before the fault stays in force for as long as new ones are late.
    held = late.values[first : first + 3, :4]
    assert np.array_equal(held, np.repeat(plain.values[first - 1 : first, :4], 3, axis=0))
    assert np.array_equal(late.values[first + 3, :4], plain.values[first, :4])
    assert effect(flown("controller late"))[3:] == pytest.approx(0.03)


def test_missed_periods_repeat_the_command() -> None:
    commands = flown("controller misses")[CONTROLS].values[250:350, :4]
    changed = [bool((a != b).any()) for a, b in pairwise(commands)]
    assert changed == [(place + 1) % 4 == 0 for place in range(99)]


def test_a_gust_is_in_the_wind_and_moves_the_vehicle() -> None:
    still, blown = (fly(*words, ideal=True, wind="calm") for words in ((), ("wind gust 0.5 1 4 0 0",)))
    assert blown[WIND]["north"].max() == pytest.approx(4.0, rel=1e-3)
    assert effect(blown) == pytest.approx(blown[WIND]["north"][50:150], abs=1e-12)
    rows = min(len(still[TRUTH]), len(blown[TRUTH]))
    assert np.abs(blown[TRUTH]["north"][:rows] - still[TRUTH]["north"][:rows]).max() > 0.01


def test_a_heavier_vehicle_sinks_by_its_weight() -> None:
    log, plain = (fly(*words, ideal=True, wind="calm") for words in (("vehicle mass 1 inf 1.25",), ()))
    row = int(np.searchsorted(log[TRUTH].time, 1.06 - 1e-9))
    gained = log[TRUTH]["descent"][row] - plain[TRUTH]["descent"][row]
    # Thrust as before for a twentieth of a second: g (1 - 1 / 1.25).
    assert gained / 0.06 == pytest.approx(9.80665 * 0.2, rel=0.1)
    assert effect(log) == pytest.approx(0.25 * read_parameters().body.mass)


def test_a_fault_stays_in_its_flight() -> None:
    before, _, after = (fly(*words) for words in ((), ("vehicle mass 0 inf 1.3", "pedal lag 0 inf 0.1"), ()))
    assert np.array_equal(before[TRUTH].values, after[TRUTH].values)


def test_an_estimate_without_fixes_drifts_and_comes_back() -> None:
    log = fly("gps dropout 0.5 inf")
    drift = np.hypot(*(log[ESTIMATE][name] - log[TRUTH][name] for name in ("north", "east")))
    assert effect(log).max() == pytest.approx(log.duration * 10.0 - 5.0, abs=2.0)
    assert drift[-1] > 3.0 * drift[: len(drift) // 8].max()


def test_a_stuck_fix_is_found_by_the_gate() -> None:
    log = flown("gps stuck")
    error = np.hypot(*(log[ESTIMATE][name] - log[TRUTH][name] for name in ("north", "east")))
    assert effect(log).max() > 1.0
    assert error.max() < 0.5


def test_faults_of_one_sensor_act_one_upon_the_other() -> None:
    log = fly("altimeter bias 2 1 1", "altimeter stuck 2.5 1")
    assert effect(log, 1)[20:] == pytest.approx(1.0)
    assert effect(log, 2).max() > 0.1


def test_a_fault_may_begin_with_the_flight_and_last() -> None:
    for kind in (kind for kind in FAULT_KINDS.values() if not kind.ends):
        name = f"{kind.where} {kind.what}"
        log = fly(f"{name} 0 inf {SIZES.get(name, '')}")
        assert log[FAULT].time.tolist() == [0.0]
        assert len(effect(log)) == len(log[CONTROLS]) - (log.header.outcome != "completed")


def test_faults_survive_the_log_file(tmp_path: Path) -> None:
    log = flown("pedal lag")
    write_log(log, tmp_path / "faulty.mcap")
    back = read_log(tmp_path / "faulty.mcap")
    assert logged_faults(back) == logged_faults(log)
    assert np.array_equal(back[FAULT_EFFECT].values, log[FAULT_EFFECT].values)
    assert log_bytes(back) == log_bytes(log)


@pytest.mark.parametrize("kind", EVERY_KIND)
def test_words_come_back(kind: str) -> None:
    fault = parse_fault(f"{kind} 2.5 1 {SIZES.get(kind, '')}")
    assert parse_fault(fault.words) == fault
    assert Fault.model_validate_json(fault.model_dump_json()) == fault


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("", "no place ''; faults have \\['gyro'"),
        ("rudder jam 1 2", "no place 'rudder'"),
        ("gps jam 1 2", "no 'jam' of gps; expected one of \\['dropout', 'stuck', 'bias', 'delay'\\]"),
        ("gps dropout", "expected 'gps dropout START DURATION' with numbers, got ''"),
        ("gps dropout one 2", "with numbers, got 'one 2'"),
        ("gps dropout 1 nan", "finite numbers"),
        ("gps dropout -1 2", "greater than or equal to 0, got -1"),
        ("gps dropout 1 0", "greater than 0, got 0"),
        ("gps delay 1 2", "expected 'gps delay START DURATION TIME', got 0 sizes"),
        ("pedal slow 1 2 3", r"share must lie in \[0, 1\]"),
        ("wind gust 1 inf 1 2 3", "expected a duration"),
    ],
)
def test_words_that_are_no_fault_are_refused(words: str, message: str) -> None:
    with pytest.raises(BadFaultError, match=message):
        parse_fault(words)


def test_ideal_sensors_cannot_fail() -> None:
    with pytest.raises(NoSensorsError, match="'gps dropout 1 2': expected sensor models"):
        fly("gps dropout 1 2", ideal=True)
    plain = FlightSpecification(seed=1, start_trim=1, ideal_navigation=True).to_json().decode()
    fault = parse_fault("gps stuck 1 2").model_dump_json()
    with pytest.raises(FlightError, match="expected sensor models"):
        parse_specification(plain.replace('"faults": []', f'"faults": [{fault}]').encode(), "test")


def test_a_fault_lasts_for_one_period_at_least() -> None:
    assert fault_window(parse_fault("gps stuck 1 0.001")) == FaultWindow(100, 101)


def test_the_command_flies_with_faults(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "walk.mcap"
    arguments = ("fly", "--sequence", "slow-walk", "--out", str(out))
    assert (
        run((*arguments, "--fault", "gps dropout 5 2", "--fault", "pedal lag 8 1 0.2", "--no-adaptation"))
        == 0
    )
    assert [fault.words for fault in logged_faults(read_log(out))] == ["gps dropout 5 2", "pedal lag 8 1 0.2"]
    assert run((*arguments, "--force", "--fault", "gps drop 5 2")) == 2
    assert capsys.readouterr().err.strip().count("\n") == 0
    assert run((*arguments, "--force", "--ideal-sensors", "--fault", "gps dropout 5 2")) == 2
    assert "expected sensor models" in capsys.readouterr().err
