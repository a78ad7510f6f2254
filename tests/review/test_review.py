"""Tests of the summary of a flight."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from flight.automaton.library import Library
from flight.errors import BadFileError, FlightError
from flight.mission.destination import Destination, Track, first_arrival
from flightlog.attachment_names import MISSION_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.mission_attachments import logged_goal, logged_plannings, logged_plans
from flightlog.primitives import PrimitiveKind, merged_primitives
from flightlog.series import Series
from flightlog.topics import COMMAND, ESTIMATE, PRIMITIVE, TRUTH
from review.summary.bound_check import check_bounds
from review.summary.summary import summarise
from tests.support.altered_logs import (
    bound_for,
    planned,
    planning,
    with_added_offset,
    with_attachment,
    with_changed_topic,
    without_topics,
)
from tests.support.synthetic_log import STILL, synthetic_library, synthetic_log

LIBRARY = synthetic_library()
WALK = (1, 2, 3, 7, 5)
COASTS = (4.0,) * 5


def still_flight(library: Library = LIBRARY) -> FlightLog:
    return synthetic_log(library, WALK, COASTS, seed=1, noise=STILL)


@settings(max_examples=20, deadline=None)
@given(choices=st.lists(st.integers(0, 5), max_size=6), coast=st.floats(0.5, 8.0), seed=st.integers(0, 99))
def test_primitives_fill_the_flight(choices: list[int], coast: float, seed: int) -> None:
    walk = [1]
    for choice in choices:
        ahead = LIBRARY.successors(walk[-1])
        walk.append(ahead[choice % len(ahead)])
    summary = summarise(synthetic_log(LIBRARY, walk, [coast] * len(walk), seed=seed))
    counts = [*summary.trims, *summary.maneuvers]
    assert sum(count.seconds for count in counts) == pytest.approx(summary.duration, abs=1e-9)
    assert sum(count.count for count in summary.maneuvers) == len(choices)


def test_a_flight_without_noise_has_no_errors_and_is_within_bounds() -> None:
    summary = summarise(still_flight())
    assert summary.tracking is not None
    assert summary.navigation is not None
    assert summary.bounds is not None
    assert [error.worst for error in summary.tracking] == [0.0, 0.0, 0.0]
    assert summary.navigation.position_max == 0.0
    assert summary.bounds.coasts == 5
    assert summary.bounds.maneuvers == 4
    assert summary.bounds.violations == ()


def test_a_flight_that_is_too_fast_leaves_every_bound() -> None:
    bounds = check_bounds(with_added_offset(still_flight(), TRUTH, "forward", 0.26))
    assert bounds is not None
    assert bounds.count_violations(PrimitiveKind.COAST) == 5
    assert {violation.number for violation in bounds.violations} == {"forward"}
    assert all(violation.bound == 0.25 for violation in bounds.violations)


def test_a_maneuver_that_ends_elsewhere_leaves_its_bound() -> None:
    first = merged_primitives(still_flight())[1]

    def jump(values: NDArray[np.float64]) -> None:
        values[round(first.end / 0.02) :, TRUTH.field_names.index("east")] += 5.0

    bounds = check_bounds(with_changed_topic(still_flight(), TRUTH, jump))
    assert bounds is not None
    (violation,) = bounds.violations
    assert (violation.kind, violation.id) == (PrimitiveKind.MANEUVER, first.id)
    assert violation.number == "side"
    assert violation.deviation == pytest.approx(5.0, abs=0.1)


def test_averaged_errors_bound_the_average_of_a_coast() -> None:
    def wave(values: NDArray[np.float64]) -> None:
        values[::2, TRUTH.field_names.index("side")] += 0.5
        values[1::2, TRUTH.field_names.index("side")] -= 0.5

    averaged = replace(LIBRARY, conditions=replace(LIBRARY.conditions, trim_error_kind="averaged"))
    kept = check_bounds(with_changed_topic(still_flight(averaged), TRUTH, wave))
    left = check_bounds(with_changed_topic(still_flight(), TRUTH, wave))
    assert kept is not None
    assert left is not None
    assert kept.count_violations(PrimitiveKind.COAST) == 0
    assert left.count_violations(PrimitiveKind.COAST) == 5


def test_an_unfinished_maneuver_is_not_held_against_its_bounds() -> None:
    log = still_flight()
    until = merged_primitives(log)[1].end - 0.5
    cut = {
        name: Series(part.topic, part.time[part.time <= until], part.values[part.time <= until])
        for name, part in log.series.items()
    }
    bounds = check_bounds(replace(log, series=cut))
    assert bounds is not None
    assert (bounds.coasts, bounds.maneuvers) == (1, 0)


def test_time_outs_are_counted() -> None:
    rule = LIBRARY.conditions.maneuver_end
    assert rule is not None
    hurried = replace(LIBRARY.conditions, maneuver_end=replace(rule, timeout=1.0))
    assert summarise(still_flight(replace(LIBRARY, conditions=hurried))).timeouts == 4
    assert summarise(still_flight()).timeouts == 0


def test_a_trim_held_through_a_planning_is_held_once() -> None:
    log = still_flight()
    rows = log[PRIMITIVE]
    again = Series(
        PRIMITIVE,
        np.insert(rows.time, 1, [1.0, 1.0]),
        np.insert(rows.values, 1, [rows.values[0], rows.values[0]], axis=0),
    )
    log = replace(log, series={**log.series, PRIMITIVE.name: again})
    assert [part.start for part in merged_primitives(log)] == rows.time.tolist()


def test_what_a_log_lacks_is_absent() -> None:
    summary = summarise(replace(without_topics(still_flight(), COMMAND, ESTIMATE), attachments={}))
    assert summary.tracking is None
    assert summary.navigation is None
    assert summary.bounds is None
    assert summary.plans is None
    assert summary.arrival is None


def test_a_log_without_any_motion_is_refused_by_name() -> None:
    with pytest.raises(FlightError, match=r"the log has no /truth; it has"):
        summarise(without_topics(still_flight(), TRUTH, ESTIMATE))


def test_the_worst_tracking_error_is_found_with_its_sign_and_time() -> None:
    def spike(values: NDArray[np.float64]) -> None:
        values[500, TRUTH.field_names.index("side")] -= 2.0

    tracking = summarise(with_changed_topic(still_flight(), TRUTH, spike)).tracking
    assert tracking is not None
    side = next(error for error in tracking if error.field == "side")
    assert side.worst == pytest.approx(-2.0)
    assert side.time == pytest.approx(10.0)
    assert side.unit == "m/s"


def test_a_whole_turn_of_heading_is_no_navigation_error() -> None:
    navigation = summarise(with_added_offset(still_flight(), ESTIMATE, "heading", 2 * pi)).navigation
    assert navigation is not None
    assert navigation.heading_rms < 1e-12
    other = summarise(with_added_offset(still_flight(), ESTIMATE, "heading", 0.1)).navigation
    assert other is not None
    assert other.heading_rms == pytest.approx(0.1)


def track_of(log: FlightLog) -> Track:
    truth = log[TRUTH]
    return np.column_stack([truth.time, *(truth[name] for name in ("north", "east", "heading"))])


def test_a_goal_passed_between_two_samples_is_reached() -> None:
    log = still_flight()
    start, end = (np.array([log[TRUTH][name][row] for name in ("north", "east")]) for row in (0, -1))
    truth = Series(TRUTH, np.array([0.0, 10.0]), log[TRUTH].values[[0, -1]])
    log = replace(log, series={**log.series, TRUTH.name: truth})
    met = first_arrival(
        [track_of(log)], Destination((float((start + end)[0] / 2), float((start + end)[1] / 2)), 0.0)
    )
    assert met.closest == pytest.approx(0.0, abs=1e-9)
    assert met.time == pytest.approx(5.0)
    aside = first_arrival([track_of(log)], Destination((float(end[0]) + 30.0, float(end[1])), 29.0))
    assert aside.time is None


def test_mission_and_plans_are_read_as_they_are_attached() -> None:
    plan = planning(1.5, (1, 2), (1.0, 3.0), gammas=(0.0, -1.0), cost=8.0)
    failed = planning(2.5, reason="nothing reaches the goal")
    log = planned(still_flight(), [plan, failed])
    assert logged_plannings(log) == (plan, failed)
    assert logged_plans(log) == (plan,)
    assert (plan.plan.deciding.gamma, plan.plan.cost) == (-1.0, 9.0)
    assert logged_goal(bound_for(log, (9.0, 0.0), 1.0)) == Destination((9.0, 0.0), 1.0)
    closer = bound_for(log, (9.0, 0.0), 1.0, final_tolerance=0.5)
    assert logged_goal(closer) == Destination((9.0, 0.0), 0.5)


@pytest.mark.parametrize("content", [{"goal": [9]}, {"goal": [9, 0], "tolerance": -1}, [], None])
def test_a_broken_mission_is_refused_by_name(content: object) -> None:
    with pytest.raises(BadFileError, match=r"mission\.json: "):
        summarise(with_attachment(still_flight(), MISSION_ATTACHMENT, content))


def test_an_attachment_that_is_no_json_is_refused_by_name() -> None:
    log = replace(still_flight(), attachments={MISSION_ATTACHMENT: b"\xff"})
    with pytest.raises(BadFileError, match=r"mission\.json: is not JSON"):
        logged_goal(log)


def test_a_log_that_lost_its_truth_in_the_middle_is_still_reviewed() -> None:
    log = still_flight()
    truth = log[TRUTH]
    kept = (truth.time < 4.5) | (truth.time > 13.0)
    holed = replace(
        log, series={**log.series, TRUTH.name: Series(TRUTH, truth.time[kept], truth.values[kept])}
    )
    whole, found = check_bounds(log), check_bounds(holed)
    assert whole is not None
    assert found is not None
    assert 0 < found.coasts < whole.coasts
