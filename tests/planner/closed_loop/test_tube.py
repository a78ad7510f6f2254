"""Tests of the flight tube within and beyond the library's errors."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import binom

from experiments.mission.fly import fly_mission, mission_seed
from experiments.mission.mission_task import MissionTask
from experiments.mission.random_missions import random_missions
from experiments.mission.result import MissionResult
from experiments.validation.tube_trial import allowed_share, count_distribution, tube_trials
from flight.automaton.vehicle import Leg
from flight.se2 import SE2, Twist
from planner.closed_loop.automaton_vehicle import AutomatonVehicle, independent_gammas
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.closed_loop.remaining_plan import PlanStep
from planner.closed_loop.tube import tube_exit_time
from planner.policies.worst_case import worst_case_planner
from scenarios.find import find_library
from tests.support.joint_laws import without_laws

LIBRARY = without_laws(find_library("gtmax-sim"))
START = SE2(3.0, -2.0, 0.7)
SLICES = 20
"""Parts of a coast with independent errors."""


def leg(begin: float, duration: float, start: SE2, end: SE2) -> Leg:
    rows = [[begin, start.x, start.y, start.heading], [begin + duration, end.x, end.y, end.heading]]
    return Leg(duration, settled=True, track=np.array(rows))


def flown(steps: Sequence[PlanStep], draw: Callable[[int], list[float]]) -> list[Leg]:
    """Flies steps with random errors, redrawn for each scalar and moment."""
    pose, time, legs = START, 0.0, []
    for step in steps:
        before, duration = pose, step.duration
        if step.to_trim is None:
            trim = LIBRARY.trim(step.trim)
            v, e = trim.velocity, trim.error
            for _ in range(SLICES):
                a, b, c = draw(3)
                velocity = Twist(v.forward + a * e.forward, v.side + b * e.side, v.yaw_rate + c * e.yaw_rate)
                pose = pose @ SE2.exp(velocity, duration / SLICES)
        else:
            row = LIBRARY.maneuver(step.trim, step.to_trim)
            a, b, c, d = draw(4)
            moved, error = row.displacement, row.error
            duration = row.duration + a * error.duration
            pose = pose @ SE2(
                moved.x + b * error.forward,
                moved.y + c * error.side,
                moved.heading + d * error.heading_change,
            )
        legs.append(leg(time, duration, before, pose))
        time += duration
    return legs


class Draw:
    """Random error shares: uniform or at the limits."""

    def __init__(self, seed: int, *, corners: bool, size: float = 1.0) -> None:
        self._rng, self._corners, self._size = np.random.default_rng(seed), corners, size

    def __call__(self, count: int) -> list[float]:
        """Returns a number of shares."""
        if self._corners:
            ends: list[float] = (self._size * self._rng.choice([-1.0, 1.0], count)).tolist()
            return ends
        drawn: list[float] = self._rng.uniform(-self._size, self._size, count).tolist()
        return drawn


def alone(place: int, size: float) -> Callable[[int], list[float]]:
    """Returns a draw of one error only."""
    return lambda count: [size if number == place else 0.0 for number in range(count)]


def walk(seed: int, maneuvers: int = 3) -> list[PlanStep]:
    rng = np.random.default_rng(seed)
    trim, steps = int(rng.integers(1, 8)), []
    for _ in range(maneuvers):
        steps.append(PlanStep(trim, float(rng.uniform(0.05, 3.0))))
        after = int(rng.choice(LIBRARY.successors(trim)))
        steps.append(PlanStep(trim, 0.0, after))
        trim = after
    return [*steps, PlanStep(trim, 2.0)]


@pytest.mark.parametrize("corners", [True, False])
def test_whoever_keeps_every_error_stays_in_the_tube(corners: bool) -> None:
    for seed in range(150):
        steps = walk(seed)
        legs = flown(steps, Draw(seed, corners=corners))
        assert tube_exit_time(LIBRARY, steps, legs, [0.0], share=1.0) is None, seed


@pytest.mark.parametrize("place", range(4))
def test_one_number_of_a_maneuver_beyond_its_error_leaves_the_tube(place: int) -> None:
    steps = [PlanStep(2, 0.0, 3)]
    for size in (-1.2, 1.2):
        legs = flown(steps, alone(place, size))
        assert tube_exit_time(LIBRARY, steps, legs, [0.0], share=1.0) == pytest.approx(legs[0].track[-1, 0])
        assert tube_exit_time(LIBRARY, steps, legs, [0.0], share=1.25) is None


@pytest.mark.parametrize("place", range(3))
def test_one_number_of_a_trim_beyond_its_error_leaves_the_tube(place: int) -> None:
    steps = [PlanStep(2, 0.5)]
    for size in (-1.3, 1.3):
        legs = flown(steps, alone(place, size))
        assert tube_exit_time(LIBRARY, steps, legs, [0.0], share=1.0) == 0.5
        assert tube_exit_time(LIBRARY, steps, legs, [0.0], share=1.35) is None


def test_what_an_alarm_broke_off_is_no_exit() -> None:
    steps = [PlanStep(2, 0.0, 3), PlanStep(3, 1.0)]
    legs = flown(steps, lambda count: [2.0] * count)
    assert tube_exit_time(LIBRARY, steps, legs, [0.0], share=1.0) is not None
    broken = [replace(legs[0], alarm="tilt"), *legs[1:]]
    assert tube_exit_time(LIBRARY, steps, broken, [0.0], share=1.0) is None


def test_a_tube_begins_anew_at_every_planning() -> None:
    steps = [PlanStep(2, 0.0, 3), PlanStep(3, 1.0), PlanStep(3, 0.0, 2), PlanStep(2, 1.0)]
    legs = flown(steps, lambda count: [1.0] * count)
    jump = SE2(0.0, 5.0, 0.0)
    moved = [
        *legs[:2],
        *(replace(one, track=one.track + np.array([0.0, jump.x, jump.y, 0.0])) for one in legs[2:]),
    ]
    third = float(legs[2].track[0, 0])
    assert tube_exit_time(LIBRARY, steps, moved, [0.0], share=1.0) is not None
    assert tube_exit_time(LIBRARY, steps, moved, [0.0, third], share=1.0) is None


def test_the_automaton_stays_in_its_tube_and_leaves_that_of_a_library_that_claims_too_much() -> None:
    (mission,) = random_missions(LIBRARY, count=1, seed=4, gamma=1.0)
    planner = worst_case_planner(LIBRARY, 1.0)
    for gamma in (-1.0, 1.0, independent_gammas(np.random.default_rng(3))):
        vehicle = AutomatonVehicle(LIBRARY, start=mission.start, trim=mission.start_trim, gamma=gamma)
        flight = fly_closed_loop(vehicle, mission, planner=planner, library=LIBRARY)
        left = [tube_exit_time(LIBRARY, flight.steps, flight.legs, flight.times, share=s) for s in (1.0, 0.7)]
        assert left[0] is None
        assert left[1] is not None


def test_the_law_of_a_count_is_the_binomial_where_the_chances_are_equal() -> None:
    assert count_distribution([0.3] * 12) == pytest.approx(binom.pmf(range(13), 12, 0.3))
    assert count_distribution([0.1, 0.9]) == pytest.approx([0.09, 0.82, 0.09])
    assert count_distribution([]) == pytest.approx([1.0])


FLIGHTS = 60
"""Enough to refute at 1 % in 19 of 20 cases: 76 % of 200 flights left the cut tube, 49 % may (binomial)."""


@pytest.fixture(scope="module")
def flights() -> list[MissionResult]:
    missions = random_missions(LIBRARY, count=FLIGHTS, seed=61, gamma=1.0)
    return [
        fly_mission(MissionTask(one, LIBRARY, "worst-case", 1.0, "gtmax", mission_seed(61, one.name, 0)))
        for one in missions
    ]


def test_the_helicopter_keeps_the_library_and_refutes_one_with_errors_cut_by_30_percent(
    flights: list[MissionResult],
) -> None:
    honest, cut = tube_trials(flights, LIBRARY)
    assert (honest.share, cut.share, honest.flights) == (1.0, 0.7, FLIGHTS)
    assert not honest.refuted
    assert cut.refuted
    assert cut.left > honest.left


def test_flights_without_claims_are_not_counted(flights: list[MissionResult]) -> None:
    silent = replace(LIBRARY, trims=tuple(replace(trim, statistics=None) for trim in LIBRARY.trims))
    assert allowed_share(flights[0], LIBRARY) is not None
    assert allowed_share(flights[0], silent) is None
    assert tube_trials(flights, silent) == ()
