"""Tests of whole flights: repeatability, logs, stability in all maneuvers."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import libraries
from flight.automaton.conditions import Conditions
from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.automaton.maneuver_end import Band, ManeuverEnd
from flight.automaton.vehicle import Vehicle
from flight.errors import FlightLostError, NoManeuverEndError
from flight.mission.sequence import Sequence
from flight.se2 import SE2, Twist
from flightlog.file.writer import log_bytes
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind, flown_primitives
from flightlog.topics import CONTROLS, ESTIMATE, PRIMITIVE, TRUTH, WIND
from sim.campaign_flight import fly_sequence, fly_specification
from sim.loop.specification import FlightSpecification, parse_specification, specify_sequence
from sim.loop.streams import Stream, random_stream
from sim.replay import VehicleMismatchError
from sim.simulated_helicopter import SimulatedHelicopter
from tests.support.commands_flown import replay

BARE = read_library(libraries.FOLDER / "thesis-gtmax.json")
# Forward, side (m/s), yaw rate (rad/s); wider than each trim's scatter in the wind class `gtmax`.
BANDS = {
    1: Band(0.16, 0.25, 0.045),
    2: Band(0.11, 0.25, 0.045),
    3: Band(0.27, 0.30, 0.06),
    4: Band(0.21, 0.30, 0.045),
    5: Band(0.21, 0.30, 0.045),
    6: Band(0.50, 0.50, 0.10),
    7: Band(0.50, 0.50, 0.10),
}
LIBRARY: Library = replace(
    BARE, conditions=Conditions(maneuver_end=ManeuverEnd(BANDS, dwell=0.3, timeout=15.0))
)
# Every one of the 22 maneuvers once, from trim 1 to trim 1.
EVERY_EDGE = (1, 2, 4, 5, 2, 5, 4, 6, 7, 6, 3, 7, 5, 7, 3, 6, 4, 2, 3, 2, 1, 3, 1)


def specify(
    *trims: int, seed: int = 1, wind: str = "gtmax", coast: float = 2.0, ideal: bool = False
) -> FlightSpecification:
    sequence = Sequence("test", SE2(5.0, -3.0, 2.0), trims, (coast,) * len(trims), wind)
    return specify_sequence(sequence, seed=seed, ideal_navigation=ideal)


def test_the_walk_of_these_tests_flies_every_maneuver_once() -> None:
    edges = list(pairwise(EVERY_EDGE))
    assert sorted(edges) == sorted((m.from_trim, m.to_trim) for m in BARE.maneuvers)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_every_trim_and_maneuver_is_flown_stably_in_gtmax_turbulence(seed: int) -> None:
    log = fly_specification(specify(*EVERY_EDGE, seed=seed), LIBRARY)
    assert log.header.outcome == "completed"
    flown = flown_primitives(log)
    assert len(flown) == 45
    assert not any(primitive.timed_out for primitive in flown)
    truth = log[TRUTH]
    assert np.abs(truth["down"] + 30.0).max() < 1.0
    assert np.abs(truth["roll"]).max() < np.radians(25.0)
    assert np.abs(truth["pitch"]).max() < np.radians(15.0)
    for primitive in flown:
        if primitive.kind is PrimitiveKind.COAST:
            inside = (truth.time >= primitive.start) & (truth.time <= primitive.end)
            for name, bound in (("forward", 0.8), ("side", 0.8), ("yaw_rate", 0.16)):
                assert np.abs(truth[name][inside] - getattr(primitive.target, name)).max() < bound


def test_the_logged_commands_and_wind_alone_reproduce_the_flight() -> None:
    log = fly_specification(specify(2, 3, 7), LIBRARY)
    again = replay(log)
    truth = log[TRUTH]
    assert again[::2].tobytes() == truth.values[: len(again[::2])].tobytes()
    # Negative control: without the logged wind the motion differs.
    still = replace(log, series={**log.series, "/wind": replace(log[WIND], values=0.0 * log[WIND].values)})
    assert np.abs(replay(still)[::2, :2] - truth.values[: len(again[::2]), :2]).max() > 0.1


def test_one_seed_gives_the_same_bytes_and_another_does_not() -> None:
    one, same, other = (log_bytes(fly_specification(specify(2, 3, seed=s), LIBRARY)) for s in (1, 1, 2))
    assert one == same
    assert one != other


def test_a_specification_in_a_log_flies_the_same_flight() -> None:
    log = fly_specification(specify(5, 7), LIBRARY)
    repeated = fly_specification(
        parse_specification(log.attachments["specification.json"], "log"), log.library()
    )
    assert log_bytes(repeated) == log_bytes(log)


@pytest.mark.parametrize("trim", [1, 3, 7])
def test_a_flight_begins_settled_at_its_start_pose(trim: int) -> None:
    helicopter = SimulatedHelicopter(specify(trim), LIBRARY)
    start, truth = SE2(5.0, -3.0, 2.0), helicopter.truth
    assert truth.pose.distance_to(start.position) < 1e-9
    assert truth.heading == pytest.approx(start.heading, abs=1e-9)
    assert helicopter.time == 0.0
    assert BANDS[trim].contains(truth.velocity, LIBRARY.trim(trim).velocity)
    # The estimate is near the truth, not equal to it.
    assert 0.0 < helicopter.pose.distance_to(start.position) < 0.5


def test_a_calm_trim_with_ideal_sensors_is_the_exact_flow() -> None:
    helicopter = SimulatedHelicopter(specify(7, wind="calm", ideal=True), LIBRARY)
    leg = helicopter.coast(10.0)
    expected = SE2(5.0, -3.0, 2.0) @ SE2.exp(LIBRARY.trim(7).velocity, 10.0)
    assert expected.distance_to((leg.track[-1, 1], leg.track[-1, 2])) < 0.05
    assert leg.track[-1, 3] == pytest.approx(expected.heading, abs=0.01)
    assert helicopter.pose == helicopter.truth.pose


@pytest.mark.parametrize(("start", "end"), [(1, 2), (2, 1), (1, 3), (3, 1), (2, 3), (3, 2)])
def test_straight_maneuvers_in_still_air_are_those_of_table_10(start: int, end: int) -> None:
    helicopter = SimulatedHelicopter(specify(start, wind="calm", ideal=True), LIBRARY)
    printed = BARE.maneuver(start, end)
    leg = helicopter.perform(printed)
    assert leg.settled
    assert leg.duration == pytest.approx(printed.duration, rel=0.15)
    displacement = SE2(*leg.track[0, 1:]).inverse() @ SE2(*leg.track[-1, 1:])
    assert displacement.x == pytest.approx(printed.displacement.x, rel=0.15)


def test_legs_join_without_a_gap() -> None:
    vehicle: Vehicle = SimulatedHelicopter(specify(2), LIBRARY)
    sequence = Sequence("odd", SE2(5.0, -3.0, 2.0), (2, 3, 2), (1.234, 0.0, 0.017), "gtmax")
    legs = fly_sequence(vehicle, sequence, library=LIBRARY)
    assert [round(leg.duration, 3) for leg in legs[::2]] == [1.23, 0.0, 0.02]
    for before, after in pairwise(legs):
        assert before.track[-1].tolist() == after.track[0].tolist()
        assert (np.diff(after.track[:, 0]) > 0.0).all()
    assert vehicle.time == legs[-1].track[-1, 0]
    assert vehicle.trim == 2


def test_the_log_has_its_rates_and_an_estimate_near_the_truth() -> None:
    log = fly_specification(specify(2, 3), LIBRARY)
    assert np.allclose(np.diff(log[TRUTH].time)[:-1], 0.02)
    assert np.allclose(np.diff(log[CONTROLS].time), 0.01)
    errors = log[ESTIMATE].values - log[TRUTH].values
    assert 0.0 < np.abs(errors[:, :2]).max() < 0.7
    assert 0.0 < np.abs(errors[:, 3:5]).max() < 0.4


def test_a_maneuver_that_does_not_settle_times_out() -> None:
    strict = ManeuverEnd(dict.fromkeys(BANDS, Band(1e-4, 1e-4, 1e-4)), dwell=1.0, timeout=3.0)
    library = replace(BARE, conditions=Conditions(maneuver_end=strict))
    helicopter = SimulatedHelicopter(specify(2), library)
    leg = helicopter.perform(library.maneuver(2, 3))
    assert not leg.settled
    assert leg.duration == pytest.approx(3.0)
    helicopter.coast(1.0)
    assert [primitive.timed_out for primitive in flown_primitives(helicopter.log())] == [True, False]


def test_a_lost_flight_has_its_reason_in_the_log() -> None:
    low = specify(1).model_copy(update={"altitude": 0.7, "wind": "light", "settling_time": 0.0})
    helicopter = SimulatedHelicopter(low, LIBRARY)
    with pytest.raises(FlightLostError, match="met the ground"):
        helicopter.coast(60.0)
    log = helicopter.log()
    assert "met the ground" in log.header.outcome
    assert log[TRUTH]["down"][-1] > -0.68
    assert log.duration == helicopter.time


def test_a_maneuver_from_another_trim_is_refused() -> None:
    helicopter = SimulatedHelicopter(specify(1, wind="calm"), LIBRARY)
    with pytest.raises(ValueError, match="maneuver 6 leaves trim 2; trim 1 is held"):
        helicopter.perform(LIBRARY.maneuver(2, 3))


def test_a_library_without_a_maneuver_end_cannot_be_flown() -> None:
    with pytest.raises(NoManeuverEndError, match=r"'thesis-gtmax': expected conditions\.maneuver_end"):
        SimulatedHelicopter(specify(1), BARE)


def test_random_streams_do_not_depend_on_one_another() -> None:
    wind, navigation = (random_stream(3, stream).standard_normal(4).tolist() for stream in Stream)
    assert wind != navigation
    assert random_stream(3, Stream.NAVIGATION).standard_normal(4).tolist() == navigation


def test_a_wind_from_the_east_is_from_the_east() -> None:
    from_east = specify(1, ideal=True).model_copy(update={"wind_from": np.pi / 2})
    helicopter = SimulatedHelicopter(from_east, LIBRARY)
    helicopter.coast(60.0)
    wind = helicopter.log()[WIND]
    assert wind["east"].mean() < -0.7
    assert Twist(0.0, 0.0, 0.0) == LIBRARY.trim(1).velocity


def test_every_command_change_has_a_true_pose_of_its_time() -> None:
    log = fly_specification(specify(1, 2, 3, coast=1.01), LIBRARY)
    assert set(log[PRIMITIVE].time) <= set(log[TRUTH].time)


def test_a_vehicle_lost_before_its_flight_has_a_log_with_that_outcome() -> None:
    low = specify(1, 3, wind="light").model_copy(update={"altitude": 0.05})
    log = fly_specification(low, LIBRARY)
    assert log.header.outcome.startswith("flight lost")


def test_a_plant_step_that_does_not_divide_the_control_period_is_refused() -> None:
    with pytest.raises(ValueError, match=r"step must divide 0\.01 s, got 0\.003 s"):
        FlightSpecification(seed=1, start_trim=1, step=0.003)


def test_a_log_of_another_vehicle_is_not_replayed() -> None:
    log = fly_specification(specify(1), LIBRARY)
    other = FlightLog(replace(log.header, model_hash="0" * 64), log.series, log.attachments)
    with pytest.raises(VehicleMismatchError, match="expected the vehicle of the log, 0000"):
        replay(other)


def test_the_adaptive_element_can_be_switched_off() -> None:
    errors = []
    for adaptive in (True, False):
        flight = specify(1, ideal=True).model_copy(update={"adaptive": adaptive})
        helicopter = SimulatedHelicopter(flight, LIBRARY)
        helicopter.coast(30.0)
        errors.append(np.sqrt((helicopter.log()[TRUTH]["side"] ** 2).mean()))
    assert errors[0] < errors[1]
