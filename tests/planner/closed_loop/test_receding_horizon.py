"""Tests of the receding horizon."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf, pi

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.vehicle import Leg, Vehicle
from flight.errors import FlightLostError
from flight.mission.destination import first_arrival
from flight.mission.mission import Mission, read_mission
from flight.plan.plan import Plan
from flight.se2 import SE2
from planner.closed_loop.automaton_vehicle import AutomatonVehicle, TrueGammaError
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.latency import Latency
from planner.closed_loop.receding_horizon import NoToleranceError, fly_closed_loop
from planner.closed_loop.settings import Settings
from planner.policies.nominal import nominal_planner
from planner.policies.policy import Planner
from planner.policies.worst_case import worst_case_planner
from scenarios.find import MISSIONS


def shipped(name: str) -> Mission:
    return read_mission(MISSIONS / f"{name}.toml")


def vehicle(library: Library, mission: Mission, gamma: float = 0.0) -> AutomatonVehicle:
    return AutomatonVehicle(library, start=mission.start, trim=mission.start_trim, gamma=gamma)


def flown(mission: Mission, settings: Settings | None = None, *, gamma: float = 0.0) -> FlightRecord:
    library = thesis_gtmax()
    return fly_closed_loop(
        vehicle(library, mission, gamma),
        mission,
        planner=nominal_planner(library),
        library=library,
        settings=settings,
    )


@dataclass
class Refusing:
    """Planner that refuses after its first few plans."""

    planner: Planner
    plans: int
    asked: list[Mission] = field(default_factory=list)

    def plan(self, mission: Mission) -> Plan:
        """Returns a plan, or a refusal."""
        self.asked.append(mission)
        plan = self.planner.plan(mission)
        if len(self.asked) <= self.plans:
            return plan
        return replace(plan, status="unknown", reason="refused", sequence=(), maneuvers=(), scenarios=())


def track(*points: tuple[float, float, float, float]) -> Leg:
    return Leg(points[-1][0] - points[0][0], settled=True, track=np.array(points, dtype=float))


def test_without_errors_and_replanning_the_flight_is_the_plan() -> None:
    mission = shipped("gtmax-2")
    library = thesis_gtmax()
    result = flown(mission, Settings(activation_interval=100.0, latency=Latency(0.0), aim=1.0))
    plan = nominal_planner(library).plan(mission)
    assert result.reached
    assert result.replans == 1
    assert result.flown_time == pytest.approx(plan.cost, abs=0.01)
    assert result.predicted_time == pytest.approx(plan.cost)


@pytest.mark.parametrize("gamma", [-0.5, 0.5])
def test_errors_are_flown_out_by_planning_again(gamma: float) -> None:
    mission, library = shipped("gtmax-2"), thesis_gtmax()
    result = fly_closed_loop(
        vehicle(library, mission, gamma), mission, planner=worst_case_planner(library, 0.5), library=library
    )
    assert result.reached
    assert result.closest <= mission.tolerance
    assert result.reason == "reached the goal"


def test_open_loop_the_same_errors_miss() -> None:
    result = flown(shipped("gtmax-2"), Settings(activation_interval=100.0, max_activations=1), gamma=-1.0)
    assert not result.reached
    assert result.closest > 0.9144
    assert "replans did not reach the goal" in result.reason


def test_a_started_maneuver_is_finished_before_planning_again() -> None:
    result = flown(shipped("gtmax-2"), Settings(activation_interval=0.5))
    # Coasts are cut by the interval; what is longer is a maneuver, flown whole.
    longer = [leg.duration for leg in result.legs if leg.duration > 0.5 + 1e-9]
    changes = [(step.trim, step.to_trim) for step in result.steps if step.to_trim is not None]
    assert longer == pytest.approx([thesis_gtmax().maneuver(*change).duration for change in changes])
    assert len(longer) >= 3


def test_replans_start_at_the_estimated_pose_with_a_tighter_tolerance() -> None:
    result = flown(shipped("gtmax-2"), Settings(tolerance_share=0.1, aim=0.5, latency=Latency(0.0)))
    tolerances = [mission.tolerance for mission in result.missions]
    distances = [mission.start.distance_to(mission.goal) for mission in result.missions]
    assert tolerances == [max(0.5 * 0.9144, 0.1 * distance) for distance in distances]
    assert tolerances[-1] < tolerances[0]
    ends = [SE2(*leg.track[-1, 1:]) for leg in result.legs]
    places = [ends.index(mission.start) for mission in result.missions[1:]]
    assert places[0] == 0
    assert sorted(set(places)) == places


def test_a_failed_replan_is_counted_and_the_previous_plan_ends_in_a_safe_stop() -> None:
    mission, library = shipped("gtmax-2"), thesis_gtmax()
    planner = Refusing(nominal_planner(library), plans=2)  # the predicted time and the first plan
    settings = Settings(max_activations=40)
    broken = vehicle(library, mission)
    result = fly_closed_loop(broken, mission, planner=planner, library=library, settings=settings)
    assert result.closest <= mission.tolerance  # at the goal, but not on a plan
    assert not result.reached
    assert result.failures == result.replans - 1 > 0
    assert result.safe_stops >= 1
    assert broken.trim == 1


def test_without_a_first_plan_nothing_is_flown() -> None:
    mission, library = shipped("gtmax-2"), thesis_gtmax()
    planner = Refusing(nominal_planner(library), plans=0)
    result = fly_closed_loop(vehicle(library, mission), mission, planner=planner, library=library)
    assert not result.reached
    assert result.legs == ()
    assert result.predicted_time == inf
    assert result.reason == "no plan from the start: refused"


def test_the_limit_of_replans_ends_the_flight_as_not_reached() -> None:
    result = flown(shipped("gtmax-1"), Settings(max_activations=2))
    assert not result.reached
    assert result.replans == 2
    assert result.flown_time == pytest.approx(sum(leg.duration for leg in result.legs))
    assert result.steps[-1].to_trim == 1  # safe stop in hover


class TimingOut(AutomatonVehicle):
    """Vehicle that never settles after a maneuver."""

    def perform(self, maneuver: Maneuver) -> Leg:
        """Flies the maneuver without settling."""
        return replace(super().perform(maneuver), settled=False)


class Falling(AutomatonVehicle):
    """Vehicle that meets the ground in its first maneuver."""

    def perform(self, maneuver: Maneuver) -> Leg:
        """Loses the vehicle."""
        raise FlightLostError(self.time, "it met the ground")


@pytest.mark.parametrize(("kind", "reason"), [(TimingOut, "timed out"), (Falling, "it met the ground")])
def test_time_outs_and_losses_end_the_flight_as_not_reached(
    kind: Callable[..., Vehicle], reason: str
) -> None:
    mission, library = shipped("gtmax-2"), thesis_gtmax()
    broken = kind(library, start=mission.start, trim=mission.start_trim, gamma=0.0)
    result = fly_closed_loop(broken, mission, planner=nominal_planner(library), library=library)
    assert not result.reached
    assert reason in result.reason


def test_a_goal_to_be_met_exactly_cannot_be_flown() -> None:
    mission, library = shipped("kinematic-1"), thesis_kinematic()
    with pytest.raises(NoToleranceError, match="kinematic-1: expected a goal tolerance > 0 m"):
        fly_closed_loop(vehicle(library, mission), mission, planner=nominal_planner(library), library=library)


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ({"activation_interval": 0.0}, "replan interval must be > 0"),
        ({"max_activations": 0}, "number of replans must be >= 1"),
        ({"final_tolerance": 0.0}, "final_tolerance must be > 0 m"),
        ({"tolerance_share": 1.0}, "tolerance_share must be in"),
        ({"aim": 0.0}, "aim must be in"),
        ({"hysteresis": -1.0}, "hysteresis must be >= 0 s"),
    ],
)
def test_settings_that_cannot_close_a_loop_are_refused(setting: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Settings(**setting)  # type: ignore[arg-type]


def test_a_true_gamma_beyond_the_errors_of_the_library_is_refused() -> None:
    with pytest.raises(TrueGammaError, match=r"between -1 and 1, got 1\.5"):
        AutomatonVehicle(thesis_gtmax(), start=SE2.identity(), trim=2, gamma=1.5)


def test_arrival_is_where_the_line_between_two_points_enters_the_disc() -> None:
    goal = Mission("goal", SE2.identity(), 1, (10.0, 0.5), 1.0)
    arrival = first_arrival([track((0, 0, 0, 0), (20, 20, 0, 0)).track], goal.destination)
    assert arrival.time == pytest.approx(10 - np.sqrt(0.75))


def test_a_track_that_passes_the_goal_has_not_arrived_and_has_a_least_distance() -> None:
    goal = Mission("goal", SE2.identity(), 1, (10.0, 1.5), 1.0)
    arrival = first_arrival([track((0, 0, 0, 0), (20, 20, 0, 0)).track], goal.destination)
    assert arrival.time is None
    assert arrival.closest == pytest.approx(1.5)


def test_a_vehicle_that_stands_in_the_goal_has_arrived() -> None:
    goal = Mission("goal", SE2.identity(), 1, (0.0, 0.5), 1.0)
    assert first_arrival([track((3, 0, 0, 0), (4, 0, 0, 0)).track], goal.destination).time == 3


def test_where_a_heading_is_wanted_arrival_waits_for_it() -> None:
    goal = Mission("goal", SE2.identity(), 1, (0.0, 0.0), 5.0, goal_heading=pi, heading_tolerance=0.5)
    turning = track((0, 0, 0, 0), (1, 0, 1, 1), (2, 0, 2, 2), (3, 0, 3, 3))
    assert first_arrival([turning.track], goal.destination).time == pytest.approx(pi - 0.5)
    elsewhere = replace(goal.destination, heading=-1.5, heading_tolerance=0.1)
    assert first_arrival([turning.track], elsewhere).time is None


class Careless:
    """Planner that ignores the trim wanted at the goal."""

    def __init__(self, library: Library) -> None:
        self._planner = nominal_planner(library)

    def plan(self, mission: Mission) -> Plan:
        """Returns the plan for the mission without the trim."""
        return self._planner.plan(replace(mission, goal_trim=None))


def test_passing_through_the_goal_in_another_trim_is_not_being_there() -> None:
    library, few = thesis_gtmax(), Settings(max_activations=6)
    through = Mission("through", SE2.identity(), 3, (12.0, 0.0), 1.0)
    assert fly_closed_loop(
        vehicle(library, through), through, planner=Careless(library), library=library
    ).reached
    hover = replace(through, goal_trim=1)
    careless = fly_closed_loop(
        vehicle(library, hover), hover, planner=Careless(library), library=library, settings=few
    )
    assert not careless.reached
    assert fly_closed_loop(
        vehicle(library, hover), hover, planner=nominal_planner(library), library=library
    ).reached
