"""Tests of supervision: alarms, safe stops and fault outcomes."""

import json
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiments.faults.fault_matrix import FaultCase, find_fault_matrix
from experiments.faults.fault_report import count_outcomes, merge_outcomes
from experiments.faults.outcome import Outcome, all_faults_acted, outcome_of
from experiments.mission.fly import fly_helicopter, fly_mission
from experiments.mission.mission_task import MissionTask
from experiments.mission.result import MissionResult
from experiments.mission.safe_envelope import EnvelopeExit, SafeEnvelope, first_exit
from flight.automaton.maneuver import Maneuver
from flight.automaton.vehicle import Leg
from flight.errors import FlightLostError
from flight.mission.fault import parse_fault
from flight.se2 import SE2
from flightlog.alarm import ADVICE, ALARM, Alarm, AlarmKind, alarms_from_series
from flightlog.decision import DecisionKind
from flightlog.events import flight_events
from flightlog.file.reader import read_log
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ESTIMATE, TRUTH
from maneuver.app import run
from planner.closed_loop.automaton_vehicle import AutomatonVehicle
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.closed_loop.settings import Settings
from planner.policies.nominal import nominal_planner
from scenarios.find import find_library, find_mission
from sim.loop.specification import FlightOptions, FlightSpecification
from sim.simulated_helicopter import SimulatedHelicopter
from sim.supervisor import LIMITS
from tests.support.mission_results import result

LIBRARY = find_library("gtmax-sim")


def flight(*words: str, supervised: bool = True, wind: str = "gtmax") -> FlightLog:
    """Flies 4 s slowly, a maneuver, and 3 s fast."""
    flight_options = FlightOptions(faults=tuple(map(parse_fault, words)), supervised=supervised)
    helicopter = SimulatedHelicopter(
        FlightSpecification(seed=8, start_trim=2, wind=wind).with_options(flight_options), LIBRARY
    )
    with suppress(FlightLostError):
        helicopter.coast(4.0)
        helicopter.perform(LIBRARY.maneuver(2, 3))
        helicopter.coast(3.0)
    return helicopter.log()


def alarms(log: FlightLog) -> tuple[Alarm, ...]:
    return alarms_from_series(log[ALARM]) if ALARM.name in log.series else ()


@pytest.mark.parametrize("wind", ["calm", "gtmax", "10"])
def test_flights_without_faults_raise_no_alarm(wind: str) -> None:
    raised = {alarm.kind for alarm in alarms(flight(wind=wind))}
    assert raised <= (ADVICE if wind == "10" else set())


@pytest.mark.parametrize(
    ("words", "kind", "within"),
    [
        ("gyro stuck 1 inf", AlarmKind.GYRO_STUCK, 0.4),
        ("gyro dropout 1 inf", AlarmKind.GYRO_STUCK, 0.4),
        ("accelerometer stuck 1 inf", AlarmKind.ACCELEROMETER_STUCK, 0.4),
        ("gps stuck 1 inf", AlarmKind.FIXES_STUCK, 0.6),
        ("gps dropout 1 inf", AlarmKind.FIXES_SILENT, 3.2),
        ("gps bias 1 inf 2 0 0", AlarmKind.FIXES_AMISS, 1.0),
        ("magnetometer stuck 1 inf", AlarmKind.HEADING_STUCK, 0.6),
        ("magnetometer dropout 1 inf", AlarmKind.HEADING_SILENT, 5.2),
        ("magnetometer bias 1 inf 1", AlarmKind.HEADING_AMISS, 2.0),
        ("altimeter stuck 1 inf", AlarmKind.ALTIMETER_STUCK, 0.6),
        ("altimeter dropout 1 inf", AlarmKind.ALTIMETER_SILENT, 5.2),
        ("altimeter bias 1 inf 5", AlarmKind.ALTIMETER_AMISS, 1.0),
        ("vehicle lift 1 inf 0.4", AlarmKind.DESCENT, 3.0),
        ("longitudinal jam 1 inf", AlarmKind.VELOCITY, 6.0),
        ("pedal jam 1 inf", AlarmKind.YAW_RATE, 10.0),
        ("controller misses 1 inf 60", AlarmKind.TILT, 13.0),
    ],
)
def test_each_kind_of_fault_raises_its_alarm_in_time(words: str, kind: AlarmKind, within: float) -> None:
    # In wind the fin holds a heading without the pedal, and gusts change what late commands do.
    wind = "calm" if words.startswith(("pedal", "controller")) else "gtmax"
    log = flight(words, wind=wind)
    found = {alarm.kind: alarm for alarm in alarms(log)}
    assert kind in found, found
    assert 1.0 < found[kind].time <= 1.0 + within
    assert not found[kind].value <= LIMITS[kind]
    assert alarms(flight(words, supervised=False, wind=wind)) == ()


def test_supervision_does_not_change_the_flight() -> None:
    supervised, unsupervised = flight(), flight(supervised=False)
    for name, series in unsupervised.series.items():
        assert (supervised.series[name].values == series.values).all(), name
    # Campaigns are unsupervised; their specifications do not mention it.
    assert "supervised" not in unsupervised.attachments["specification.json"].decode()
    assert json.loads(supervised.attachments["specification.json"])["supervised"] is True


def test_alarms_survive_the_log_and_are_events(tmp_path: Path) -> None:
    log = flight("gps stuck 1 inf")
    write_log(log, tmp_path / "flight.mcap")
    again = read_log(tmp_path / "flight.mcap")
    assert alarms(again) == alarms(log)
    texts = [event.text for event in flight_events(again) if event.source == "alarm"]
    assert texts[0].startswith("fixes bitwise unchanged: 0.4 s, limit 0.35 s")


class Doubting(AutomatonVehicle):
    """Vehicle with an alarm in its third and every later leg."""

    legs = 0

    def coast(self, duration: float) -> Leg:
        """Holds the trim, with an alarm from the third leg on."""
        self.legs += 1
        return replace(super().coast(duration), alarm="doubt" if self.legs >= 3 else "")


def test_an_alarm_ends_the_mission_in_hover_and_stands_in_the_log() -> None:
    mission = find_mission("gtmax-1")
    vehicle = Doubting(LIBRARY, start=mission.start, trim=mission.start_trim, gamma=0.0)
    flown = fly_closed_loop(
        vehicle, mission, planner=nominal_planner(LIBRARY), library=LIBRARY, settings=Settings(wait=5.0)
    )
    assert (flown.reached, flown.claimed, flown.reason) == (False, False, "alarm: doubt")
    kinds = [decision.kind for decision in flown.decisions]
    assert kinds.index(DecisionKind.ALARM) < kinds.index(DecisionKind.FALLBACK)
    assert vehicle.trim == 1
    assert flown.legs[-1].duration == 5.0


class Mistaken(AutomatonVehicle):
    """Vehicle with an estimate east of the truth."""

    east = 2.0

    @property
    def pose(self) -> SE2:
        """Estimated pose."""
        pose = super().pose
        return SE2(pose.x, pose.y + self.east, pose.heading)

    def coast(self, duration: float) -> Leg:
        """Holds the trim."""
        return self._mistaken(super().coast(duration))

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs the maneuver."""
        return self._mistaken(super().perform(maneuver))

    def _mistaken(self, leg: Leg) -> Leg:
        return replace(leg, estimated_track=np.add(leg.track, (0.0, 0.0, self.east, 0.0)))


class Uncertain(AutomatonVehicle):
    """Vehicle with a position standard deviation of 2 m."""

    def coast(self, duration: float) -> Leg:
        """Holds the trim."""
        return replace(super().coast(duration), standard_deviation=2.0)

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs the maneuver."""
        return replace(super().perform(maneuver), standard_deviation=2.0)


def test_a_declared_arrival_away_from_the_goal_is_no_arrival() -> None:
    mission = find_mission("gtmax-2")
    vehicle = Mistaken(LIBRARY, start=mission.start, trim=mission.start_trim, gamma=0.0)
    flown = fly_closed_loop(vehicle, mission, planner=nominal_planner(LIBRARY), library=LIBRARY)
    assert flown.claimed
    assert not flown.reached
    assert flown.closest > mission.tolerance
    assert flown.reason.startswith("vehicle declared arrival, but")


def test_an_uncertain_position_prevents_the_declaration_of_arrival() -> None:
    mission = find_mission("gtmax-2")

    def flown(probability: float) -> bool:
        vehicle = Uncertain(LIBRARY, start=mission.start, trim=mission.start_trim, gamma=0.0)
        settings = Settings(arrival_probability=probability, max_activations=40)
        return fly_closed_loop(
            vehicle, mission, planner=nominal_planner(LIBRARY), library=LIBRARY, settings=settings
        ).claimed

    assert not flown(0.99)
    assert flown(0.0)


def altered(log: FlightLog, place: int, **values: float) -> FlightLog:
    """Returns the log with other true values from a row on."""
    truth = log[TRUTH]
    table = truth.values.copy()
    for name, value in values.items():
        table[place:, TRUTH.field_names.index(name)] += value
    return replace(log, series={**log.series, TRUTH.name: Series(TRUTH, truth.time, table)})


def test_a_flight_leaves_its_envelope_where_its_truth_does() -> None:
    log, envelope = flight(), SafeEnvelope()
    time = log[TRUTH].time[100]
    assert first_exit(log, envelope) is None
    for values in ({"roll": 0.8}, {"pitch": -0.8}, {"down": 6.0}, {"north": 1.2}, {"heading": 0.5}):
        found = first_exit(altered(log, 100, **values), envelope)
        assert found is not None, values
        assert found.time == time
    assert first_exit(altered(log, 100, heading=2 * np.pi), envelope) is None
    no_number = first_exit(altered(log, 100, roll=np.nan), envelope)
    assert no_number is not None
    assert no_number.time == time
    lost = replace(log, header=replace(log.header, outcome="flight lost: in the ground"))
    assert first_exit(lost, envelope) == EnvelopeExit(log.duration, "flight lost: in the ground")
    with pytest.raises(ValueError, match="must be > 0"):
        SafeEnvelope(tilt=0.0)


GONE = EnvelopeExit(5.0, "gone")


@pytest.mark.parametrize(
    ("changes", "came_to"),
    [
        ({"reached": True, "claimed": True}, Outcome.SAFE),
        ({"reached": False, "claimed": False}, Outcome.SAFE),
        ({"reached": False, "claimed": True}, Outcome.UNDETECTED_FAILURE),
        ({"reached": False, "claimed": False, "left": GONE}, Outcome.UNDETECTED_FAILURE),
        ({"reached": True, "claimed": True, "left": GONE}, Outcome.UNDETECTED_FAILURE),
        (
            {"reached": False, "claimed": False, "left": GONE, "alarms": (Alarm(4.0, AlarmKind.TILT, 1, 0),)},
            Outcome.DETECTED_LOSS,
        ),
        (
            {"reached": False, "claimed": False, "left": GONE, "alarms": (Alarm(5.9, AlarmKind.TILT, 1, 0),)},
            Outcome.DETECTED_LOSS,
        ),
        (
            {"reached": False, "claimed": False, "left": GONE, "alarms": (Alarm(6.1, AlarmKind.TILT, 1, 0),)},
            Outcome.UNDETECTED_FAILURE,
        ),
    ],
)
def test_what_a_flight_came_to(changes: dict[str, object], came_to: Outcome) -> None:
    assert outcome_of(replace(result("a", 0), **changes)) is came_to  # type: ignore[arg-type]


def rows_of(count: int, **changes: object) -> list[MissionResult]:
    return [replace(result("a", n), effects=(1.0,), **changes) for n in range(count)]  # type: ignore[arg-type]


def test_outside_the_contract_nothing_passes_wherever_it_went() -> None:
    fault = parse_fault("gps dropout 2 inf")
    rows = rows_of(20)
    inside = count_outcomes(FaultCase(fault, contract=True, expected=""), rows)
    outside = count_outcomes(FaultCase(fault, contract=False, expected=""), rows)
    assert (inside.passed, inside.safe, inside.undetected_failure) == (20, 20, 0)
    assert (outside.passed, outside.safe, outside.undetected_failure) == (None, 20, 0)
    assert merge_outcomes([inside, outside]).passed is None
    # 0 of 20: the share p with (1 - p)^20 = 0.05.
    assert outside.undetected_failure_at_most == pytest.approx(1 - 0.05 ** (1 / 20))
    assert count_outcomes(FaultCase(fault, contract=True, expected=""), rows_of(3, claimed=False)).passed == 3
    alarmed = rows_of(3, alarms=(Alarm(4.0, AlarmKind.TILT, 1.0, 0.5),))
    assert count_outcomes(FaultCase(fault, contract=True, expected=""), alarmed).passed == 0


def test_a_fault_that_did_nothing_is_not_seen_to_act() -> None:
    assert all_faults_acted(replace(result("a", 0), effects=(0.3,)))
    assert not all_faults_acted(replace(result("a", 0), effects=(0.0,)))
    assert not all_faults_acted(result("a", 0))


def test_a_stuck_gyro_is_detected_only_with_supervision() -> None:
    def flown(*, supervised: bool) -> MissionResult:
        flight_options = FlightOptions(faults=(parse_fault("gyro stuck 2 inf"),), supervised=supervised)
        return fly_mission(
            MissionTask(
                find_mission("gtmax-2"), LIBRARY, "worst-case", 1.0, "gtmax", 3, flight_options=flight_options
            )
        )

    with_it, without = flown(supervised=True), flown(supervised=False)
    assert all_faults_acted(with_it)
    assert all_faults_acted(without)
    assert outcome_of(with_it) is Outcome.DETECTED_LOSS
    assert outcome_of(without) is Outcome.UNDETECTED_FAILURE


def test_missions_are_supervised() -> None:
    task = MissionTask(find_mission("gtmax-2"), LIBRARY, "nominal", 0.0, "gtmax", 1)
    flown, log = fly_helicopter(task)
    assert json.loads(log.attachments["specification.json"])["supervised"] is True
    assert flown.claimed
    estimate = log[ESTIMATE]
    nearest = np.hypot(estimate["north"] - task.mission.goal[0], estimate["east"] - task.mission.goal[1])
    assert nearest.min() < task.mission.tolerance


def test_the_shipped_matrix_has_more_than_twelve_kinds_inside_and_out() -> None:
    matrix = find_fault_matrix("helicopter")
    kinds = {(case.fault.where, case.fault.what) for case in matrix.cases}
    assert len(kinds) > 30
    assert sum(case.contract for case in matrix.cases) > 12
    assert sum(not case.contract for case in matrix.cases) > 12
    assert all(case.expected for case in matrix.cases)


SMALL = """name = "small"
[envelope]
tilt = 0.7
height = 5.0
position = 1.0
heading = 0.35
[[fault]]
words = "gps stuck 2 inf"
contract = false
expected = "alarm"
"""


def test_a_matrix_is_flown_kept_and_written(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, out = tmp_path / "small.toml", tmp_path / "out"
    file.write_text(SMALL)
    words = ("faults", str(file), "--flights", "1", "--seed", "3", "--workers", "1", "--out", str(out))
    assert run((*words, "--json")) == 0
    document = json.loads(capsys.readouterr().out)
    (row,) = document["faults"]
    assert row["protected"]["acted"] == row["protected"]["flights"] == 1
    assert row["protected"]["undetected_failure"] == 0
    assert row["protected"]["passed"] is None
    assert len(list((out / "flights").iterdir())) == 3
    assert "| `gps stuck 2 inf` | 1 | 1 | - |" in (out / "fault-matrix.md").read_text()
    assert len((out / "fault-matrix.csv").read_text().splitlines()) == 4
    assert run(words) == 0
    assert "undetected failures with protection: 0 of 1" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [
        ("gps stuck 2 inf", "gps stuck two inf", "fault 'gps stuck two inf': expected 'gps stuck START"),
        ("gps stuck 2 inf", "gps asleep 2 inf", "no 'asleep' of gps"),
        ("tilt = 0.7", "tilt = 0", "envelope.tilt"),
        (
            'expected = "alarm"\n',
            'expected = "alarm"\n' + SMALL[SMALL.index("[[") :],
            "expected different faults, got",
        ),
        (SMALL[SMALL.index("[[") :], "fault = []\n", "expected one or more"),
    ],
)
def test_a_broken_matrix_is_refused_in_one_line(
    old: str, new: str, problem: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "broken.toml"
    file.write_text(SMALL.replace(old, new) if not new.startswith("fault") else new + SMALL.replace(old, ""))
    assert run(("faults", str(file))) == 2
    error = capsys.readouterr().err
    assert problem in error
    assert error.count("\n") == 1


def test_a_matrix_that_is_not_there_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(("faults", "nowhere")) == 2
    assert "no fault matrix 'nowhere': expected an existing file or one of ['helicopter']" in (
        capsys.readouterr().err
    )
