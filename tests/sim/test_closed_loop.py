"""Tests of the closed loop: latency, hysteresis, gamma estimation, safe stops."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import cycle

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.vehicle import Leg
from flight.errors import FlightLostError
from flight.mission.mission import Mission, read_mission
from flight.plan.plan import Plan, Scenario
from flight.se2 import SE2
from flightlog.decision import DECISION, DecisionKind, decision_series
from maneuver.validate import THESIS_MISSIONS
from planner.closed_loop.automaton_vehicle import AutomatonVehicle, TrueGammaError, independent_gammas
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.gamma_estimator import GammaEstimator
from planner.closed_loop.latency import Latency, LatencyRecordError
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.closed_loop.remaining_plan import PlanStep, RemainingPlan
from planner.closed_loop.settings import Settings
from planner.policies.nominal import nominal_planner
from planner.policies.policy import Planner
from planner.policies.worst_case import worst_case_planner
from planner.walks.safe_stop import rest_trim, safe_stop_path
from scenarios.find import MISSIONS, find_library
from sim.loop.specification import FlightSpecification, specified_pose
from sim.simulated_helicopter import SimulatedHelicopter

LIBRARY = find_library("gtmax-sim")


def shipped(name: str) -> Mission:
    return read_mission(MISSIONS / f"{name}.toml")


def flown(
    mission: Mission,
    gamma: float | Iterator[float] = 0.0,
    *,
    settings: Settings | None = None,
    planner: Planner | None = None,
) -> FlightRecord:
    vehicle = AutomatonVehicle(LIBRARY, start=mission.start, trim=mission.start_trim, gamma=gamma)
    planner = planner or nominal_planner(LIBRARY)
    return fly_closed_loop(vehicle, mission, planner=planner, library=LIBRARY, settings=settings)


def test_the_worst_case_mostly_meets_its_predicted_time_at_the_gammas_planned_for() -> None:
    """The bound assumes a known gamma; the loop estimates it in flight."""
    results = [
        flown(shipped(name), gamma, planner=worst_case_planner(LIBRARY, 1.0))
        for name in THESIS_MISSIONS
        for gamma in (-1.0, 0.0, 1.0)
    ]
    assert all(result.reached and result.failures == result.safe_stops == 0 for result in results)
    assert sum(result.flown_time <= result.predicted_time for result in results) >= 12


def test_a_loop_without_estimation_and_hysteresis_misses_the_predicted_time() -> None:
    """Negative control: no gamma estimate, no hysteresis, tolerance by distance."""
    careless = Settings(learn_level=False, hysteresis=0.0, tolerance_share=0.1, aim=1.0, max_activations=120)
    late = [
        not result.reached or result.flown_time > result.predicted_time
        for name in THESIS_MISSIONS
        for result in [
            flown(shipped(name), -1.0, settings=careless, planner=worst_case_planner(LIBRARY, 1.0))
        ]
    ]
    assert sum(late) >= 3


@pytest.mark.parametrize("latency", [0.0, 0.05, 0.7, 2.0])
@pytest.mark.parametrize("replan_in_maneuver", [False, True])
def test_a_plan_begins_where_the_vehicle_is_when_it_is_there(
    latency: float, replan_in_maneuver: bool
) -> None:
    mission = shipped("gtmax-2")
    settings = Settings(
        latency=Latency(latency), replan_in_maneuver=replan_in_maneuver, hysteresis=0.0, aim=0.9
    )
    result = flown(mission, settings=settings)
    assert result.reached
    adopted = [one for one in result.decisions if one.kind is DecisionKind.ADOPTED]
    track = np.concatenate([leg.track for leg in result.legs])
    assert len(adopted) >= 2
    for one in adopted:
        asked = result.missions[one.activation - 1].start
        there = [np.interp(one.time, track[:, 0], track[:, place]) for place in (1, 2, 3)]
        assert there == pytest.approx([asked.x, asked.y, asked.heading], abs=1e-6)
        assert one.time >= result.times[one.activation - 1] + latency - 1e-9


def test_latency_is_charged_to_the_flight() -> None:
    mission = shipped("gtmax-2")
    prompt, slow = (flown(mission, settings=Settings(latency=Latency(time))) for time in (0.0, 1.5))
    assert prompt.legs[0].duration != slow.legs[0].duration == pytest.approx(1.5)
    assert slow.predicted_time > 1.5


@dataclass
class Slow:
    """Planner with given planning times."""

    planner: Planner
    times: Iterator[float]

    def plan(self, mission: Mission) -> Plan:
        """Returns the plan with the next planning time."""
        return replace(self.planner.plan(mission), solve_time=next(self.times))


def test_a_late_plan_is_not_flown_and_a_record_of_times_repeats_the_flight() -> None:
    mission = shipped("gtmax-2")
    slow = Slow(nominal_planner(LIBRARY), cycle([0.01, 0.01, 0.01, 0.01, 0.3]))
    measured = flown(mission, settings=Settings(latency=Latency(0.05, measured=True)), planner=slow)
    late = [one for one in measured.decisions if one.kind is DecisionKind.LATE]
    assert late
    assert measured.failures == len(late)
    assert all(one.latency > 0.05 for one in late)
    recorded = Latency(0.05, measured=True, recorded=measured.latencies)
    again = flown(mission, settings=Settings(latency=recorded))
    assert again.decisions == measured.decisions
    assert again.flown_time == measured.flown_time
    with pytest.raises(LatencyRecordError, match="got only 1"):
        flown(mission, settings=Settings(latency=replace(recorded, recorded=measured.latencies[:1])))


class WrongPlanner:
    """Planner with wrong verified plans from the fourth replan on."""

    def __init__(self) -> None:
        self._nominal, self._replans = nominal_planner(LIBRARY), 0

    def plan(self, mission: Mission) -> Plan:
        """Returns a plan whose claimed end and time are wrong."""
        self._replans += 1
        plan = self._nominal.plan(mission)
        if self._replans <= 3 or not plan.found:
            return plan
        end = SE2(*mission.goal, 0.0)
        times = (0.0,) * len(plan.sequence)
        return replace(plan, scenarios=(Scenario(0.0, 0.1, times, end),), verified=True)


def test_a_wrong_plan_is_refused_although_it_claims_to_be_verified() -> None:
    result = flown(shipped("gtmax-2"), planner=WrongPlanner(), settings=Settings(max_activations=60))
    kinds = {one.kind for one in result.decisions}
    assert DecisionKind.REFUSED in kinds
    assert DecisionKind.FALLBACK in kinds
    assert not result.reached
    assert 1 in {result.steps[-1].trim, result.steps[-1].to_trim}


def test_a_plan_under_way_is_kept_until_another_is_clearly_faster() -> None:
    def kept(hysteresis: float) -> int:
        flights = [
            flown(shipped(name), 0.5, settings=Settings(hysteresis=hysteresis, aim=0.3))
            for name in THESIS_MISSIONS
        ]
        return sum(one.kind is DecisionKind.KEPT for flight in flights for one in flight.decisions)

    assert kept(0.0) == 0 < kept(1.0)


def test_planning_in_a_maneuver_has_the_plan_ready_at_its_end() -> None:
    mission = shipped("gtmax-2")
    settings = Settings(replan_in_maneuver=True, latency=Latency(0.5))
    result = flown(mission, 0.3, settings=settings)
    ends = {
        round(leg.track[-1, 0], 6)
        for leg, step in zip(result.legs, result.steps, strict=True)
        if step.to_trim
    }
    decided = {round(one.time, 6) for one in result.decisions}
    assert ends <= decided | {round(result.legs[-1].track[-1, 0], 6)}


@pytest.mark.parametrize("gamma", [-1.0, 0.0, 1.0])
def test_gamma_is_estimated_from_one_primitive(gamma: float) -> None:
    levels = GammaEstimator(LIBRARY, (30.0, 10.0))
    assert levels.estimate((0.0, -1.0, 1.0), otherwise=-1.0) == -1.0
    begin = SE2(1.0, 2.0, 0.3)
    step = PlanStep(2, 0.0, 3)
    levels.update(step, begin, step.exit(begin, LIBRARY, gamma))
    assert levels.estimate((0.0, -1.0, 1.0), otherwise=-1.0) == gamma
    # Later candidates are compared with all observations.
    assert levels.estimate((0.5 * gamma, gamma), otherwise=-1.0) == gamma


@pytest.mark.parametrize("trim", [trim.id for trim in LIBRARY.trims])
def test_every_trim_has_a_safe_stop(trim: int) -> None:
    path = (trim, *safe_stop_path(LIBRARY, trim))
    LIBRARY.maneuvers_along(path)
    assert path[-1] == rest_trim(LIBRARY) == 1
    assert LIBRARY.trim(path[-1]).velocity.forward == 0


def test_without_a_hover_rest_is_the_slowest_straight_trim() -> None:
    assert rest_trim(thesis_kinematic()) == 1
    assert safe_stop_path(thesis_kinematic(), 1) == ()


def test_every_plan_has_a_safe_stop_path() -> None:
    plan = nominal_planner(LIBRARY).plan(shipped("gtmax-2"))
    assert plan.tail[-1] == 1
    LIBRARY.maneuvers_along((plan.sequence[-1], *plan.tail))


def test_the_remaining_plan_ends_where_the_plan_does() -> None:
    mission = shipped("gtmax-2")
    plan = worst_case_planner(LIBRARY, 1.0).plan(mission)
    assert len(plan.scenarios) == 3
    for scenario in plan.scenarios:
        end, time = RemainingPlan.of(plan, scenario).predicted_end(mission.start, LIBRARY, scenario.gamma)
        assert time == pytest.approx(scenario.cost)
        assert end.position == pytest.approx(scenario.end.position, abs=1e-6)


def test_primitives_with_errors_of_their_own_repeat_with_their_seed() -> None:
    mission = shipped("gtmax-2")
    first, second, other = (
        flown(mission, independent_gammas(np.random.default_rng(seed))) for seed in (1, 1, 2)
    )
    assert first.flown_time == second.flown_time
    assert first.flown_time != other.flown_time


def test_a_trim_keeps_its_error_as_long_as_it_is_held() -> None:
    vehicle = AutomatonVehicle(LIBRARY, start=SE2.identity(), trim=2, gamma=iter([0.5, 2.0]))
    vehicle.coast(0.5)
    vehicle.coast(0.5)
    expected = SE2.exp(LIBRARY.trim(2).at(0.5), 1.0)
    assert vehicle.pose.position == pytest.approx(expected.position)
    with pytest.raises(TrueGammaError, match="got 2"):
        vehicle.perform(LIBRARY.maneuver(2, 3))


class Falling(AutomatonVehicle):
    """Vehicle that hits the ground half a second into its first maneuver."""

    def perform(self, maneuver: Maneuver) -> Leg:
        """Loses the vehicle."""
        error = FlightLostError(self.time + 0.5, "it met the ground")
        begin = (self.time, *self.pose.position, self.pose.heading)
        error.track = np.array([begin, (self.time + 0.5, 99.0, 0.0, 0.0)])
        raise error


def test_the_track_of_the_leg_in_which_the_vehicle_is_lost_is_kept() -> None:
    mission = shipped("gtmax-2")
    falling = Falling(LIBRARY, start=mission.start, trim=mission.start_trim, gamma=0.0)
    result = fly_closed_loop(falling, mission, planner=nominal_planner(LIBRARY), library=LIBRARY)
    assert not result.reached
    assert "it met the ground" in result.reason
    assert result.legs[-1].track[-1, 1] == 99.0
    assert not result.legs[-1].settled


def test_decisions_are_a_topic_of_the_log_in_the_order_of_time() -> None:
    series = decision_series(flown(shipped("gtmax-2")).decisions)
    assert series.topic is DECISION
    assert (np.diff(series.time) >= 0).all()
    assert DecisionKind.ARRIVED in series["kind"][-2:]
    assert series["activation"][0] == 1


def test_a_safe_stop_needs_maneuvers() -> None:
    library: Library = thesis_gtmax()
    stranded = replace(library, maneuvers=library.maneuvers[:1])
    assert safe_stop_path(stranded, 3) == ()
    assert safe_stop_path(stranded, 2) == (1,)


def test_the_helicopter_returns_its_track_before_it_was_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    mission = shipped("gtmax-2")
    specification = FlightSpecification(
        seed=1, start=specified_pose(mission.start), start_trim=2, settling_time=1.0
    )
    helicopter = SimulatedHelicopter(specification, LIBRARY)
    advance = SimulatedHelicopter._advance

    def fall(self: SimulatedHelicopter) -> None:
        if self.time >= 6.0:
            raise FlightLostError(self.time, "it met the ground")
        advance(self)

    monkeypatch.setattr(SimulatedHelicopter, "_advance", fall)
    result = fly_closed_loop(helicopter, mission, planner=nominal_planner(LIBRARY), library=LIBRARY)
    assert not result.reached
    assert result.flown_time == pytest.approx(6.0)
    assert result.legs[-1].track[-1, 0] == pytest.approx(6.0)
