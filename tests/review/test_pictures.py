"""Tests of pictures against the data that they show."""

from dataclasses import replace
from itertools import pairwise
from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from flight.errors import AlreadyExistsError
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from flight.plan.planned_track import planned_track
from flight.se2 import SE2
from flightlog.log import FlightLog
from flightlog.primitives import merged_primitives
from flightlog.series import Series
from flightlog.topics import CONTROLS, ESTIMATE, TRUTH, WIND
from flightlog.trim_labels import trim_colors
from review.pictures import palette
from review.pictures.flight_picture import track_picture, write_picture, write_pictures
from review.pictures.plan_picture import plan_picture
from review.pictures.primitive_lane import draw_primitive_lane
from review.pictures.time_histories import draw_control, draw_velocity, draw_wind
from review.pictures.track_picture import draw_track
from tests.support.altered_logs import bound_for, planned, planning
from tests.support.reviewed_flights import plan_of
from tests.support.synthetic_log import STILL, synthetic_library, synthetic_log

LIBRARY = synthetic_library()
WALK = (1, 2, 3, 7)
COASTS = (2.0,) * 4


@pytest.fixture(scope="module")
def flight() -> FlightLog:
    """Returns a mission's log with every topic and attachment."""
    log = synthetic_log(LIBRARY, WALK, COASTS, seed=1, start=SE2(5.0, -3.0, 0.7), kind="mission")
    controls = Series(CONTROLS, log[TRUTH].time, 0.1 * log[TRUTH].values[:, :8])
    log = replace(log, series={**log.series, CONTROLS.name: controls})
    plans = [planning(time, WALK, COASTS, gammas=(0.0,)) for time in (0.0, 3.0)]
    return bound_for(planned(log, plans), (20.0, 10.0), 2.0)


def poor(log: FlightLog) -> FlightLog:
    """Returns the log with truth and primitives alone."""
    gone = {WIND.name, ESTIMATE.name, CONTROLS.name, "/command"}
    return FlightLog(log.header, {k: v for k, v in log.series.items() if k not in gone}, {})


def test_every_picture_is_drawn_that_the_log_has_topics_for(flight: FlightLog, tmp_path: Path) -> None:
    rich = write_pictures(flight, tmp_path / "rich", limits={"lateral": (-0.15, 0.15)})
    assert [path.stem for path in rich] == [
        *("flight", "track", "velocities", "attitude_and_controls", "wind", "navigation_error")
    ]
    meagre = write_pictures(poor(flight), tmp_path / "meagre")
    assert [path.stem for path in meagre] == ["flight", "track", "velocities", "attitude_and_controls"]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in (*rich, *meagre))


def test_equal_logs_give_equal_pictures(flight: FlightLog, tmp_path: Path) -> None:
    paths = [tmp_path / "first.png", tmp_path / "second.png"]
    for path in paths:
        write_picture(track_picture(flight), path)
    assert paths[0].read_bytes() == paths[1].read_bytes()


def test_where_one_picture_would_be_overwritten_none_is_written(flight: FlightLog, tmp_path: Path) -> None:
    (tmp_path / "velocities.png").write_bytes(b"mine")
    with pytest.raises(AlreadyExistsError, match=r"velocities\.png exists"):
        write_pictures(flight, tmp_path)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"mine"]


def test_the_plan_view_is_true_to_scale_with_north_up(flight: FlightLog) -> None:
    axes = palette.new_figure(6.0, 6.0).subplots()
    draw_track(axes, poor(flight))
    assert axes.get_aspect() == 1.0
    lines = [line for line in axes.lines if line.get_zorder() == 4.0]
    assert len(lines) == len(merged_primitives(flight)) == 7
    points = np.concatenate([np.asarray(line.get_xydata()) for line in lines])
    truth = np.column_stack([flight[TRUTH]["east"], flight[TRUTH]["north"]])
    np.testing.assert_allclose(np.unique(points, axis=0), np.unique(truth, axis=0), atol=1e-9)


def test_goal_plans_and_wind_are_drawn_where_the_log_has_them(flight: FlightLog) -> None:
    def legend_and_words(log: FlightLog) -> tuple[set[str], int]:
        axes = palette.new_figure(6.0, 6.0).subplots()
        draw_track(axes, log)
        legend = axes.get_legend()
        assert legend is not None
        return {text.get_text() for text in legend.get_texts()}, len(axes.patches)

    rich, patches = legend_and_words(flight)
    assert {"goal, within 2 m", "first plan", "later plans: 1", "7 fast right turn"} <= rich
    assert patches == 2
    meagre, patches = legend_and_words(poor(flight))
    assert meagre == {"trim 1", "trim 2", "trim 3", "trim 7", "maneuver between trims"}
    assert patches == 0


@settings(max_examples=30, deadline=None)
@given(
    gamma=st.sampled_from([-1.0, 0.0, 0.5]),
    heading=st.floats(-pi, pi),
    coasts=st.lists(st.floats(0.0, 20.0), min_size=4, max_size=4),
)
def test_a_planned_track_leads_where_the_automaton_leads(
    gamma: float, heading: float, coasts: list[float]
) -> None:
    start = SE2(3.0, -4.0, heading)
    pose = start
    for place, (trim, time) in enumerate(zip(WALK, coasts, strict=True)):
        pose = pose @ SE2.exp(LIBRARY.trim(trim).at(gamma), time)
        if place < len(WALK) - 1:
            pose = pose @ LIBRARY.maneuver(trim, WALK[place + 1]).at(gamma).displacement
    held, joints = planned_track(LIBRARY, WALK, coasts, start=start, gamma=gamma)
    np.testing.assert_allclose(held[0][0], start.position, atol=1e-9)
    np.testing.assert_allclose(held[-1][-1], pose.position, atol=1e-9)
    for joint, (before, after) in zip(joints, pairwise(held), strict=True):
        np.testing.assert_allclose(joint[[0, -1]], [before[-1], after[0]], atol=1e-9)


def test_the_lane_underlines_what_left_its_bounds_and_nothing_else() -> None:
    def underlined(log: FlightLog) -> int:
        axes = palette.new_figure(8.0, 1.0).subplots()
        draw_primitive_lane(axes, log, width=8.0)
        blocks = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
        return sum(block.get_y() < 0 for block in blocks)

    still = synthetic_log(LIBRARY, WALK, COASTS, seed=1, noise=STILL)
    values = still[TRUTH].values.copy()
    values[:, TRUTH.field_names.index("side")] += 0.3
    fast = replace(still, series={**still.series, TRUTH.name: replace(still[TRUTH], values=values)})
    assert underlined(still) == 0
    assert underlined(fast) == 4


def test_a_velocity_panel_shows_command_estimate_truth_and_bounds(flight: FlightLog) -> None:
    axes = palette.new_figure(8.0, 2.0).subplots()
    draw_velocity(axes, flight, "yaw_rate")
    shown = {to_rgba(line.get_color()): line for line in axes.lines}
    truth = np.asarray(shown[to_rgba(palette.TRUE_COLOR)].get_ydata())
    np.testing.assert_allclose(truth, np.degrees(flight[TRUTH]["yaw_rate"]))
    assert {to_rgba(palette.ESTIMATE_COLOR), to_rgba(palette.INK)} <= set(shown)
    bands = [band for band in axes.collections if band.get_alpha() == 0.25]
    assert len(bands) == len(WALK)


def test_a_limit_is_drawn_where_the_control_comes_near_and_said_anyway(flight: FlightLog) -> None:
    def panel(limit: float) -> tuple[str, bool]:
        axes = palette.new_figure(8.0, 2.0).subplots()
        draw_control(axes, flight, "pedal", {"pedal": (-limit, limit)})
        low, high = axes.get_ylim()
        lines = [line for line in axes.lines if to_rgba(line.get_color()) == to_rgba(palette.ALARM)]
        heights = [float(np.asarray(line.get_ydata())[0]) for line in lines]
        return axes.get_title("left"), any(low <= height <= high for height in heights)

    largest = float(np.abs(flight[CONTROLS]["pedal"]).max())
    near, far = panel(0.99 * largest), panel(50 * largest + 1.0)
    assert "limits" in near[0]
    assert "limits" in far[0]
    assert near[1]
    assert not far[1]


def test_trims_differ_in_colour() -> None:
    colors = trim_colors(range(14))
    assert len(set(colors.values())) == 14


def test_rates_of_the_air_are_shown_in_degrees(flight: FlightLog) -> None:
    axes = palette.new_figure(8.0, 2.0).subplots()
    values = np.tile(np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]), (len(flight[WIND]), 1))
    windy = replace(flight, series={WIND.name: replace(flight[WIND], values=values), **poor(flight).series})
    draw_wind(axes, windy, WIND.field_names[3:], "rotation")
    shown = [float(np.asarray(line.get_ydata())[0]) for line in axes.lines]
    assert shown == pytest.approx(np.degrees([0.1, 0.2, 0.3]).tolist())


def legend(plan: Plan) -> dict[str, Line2D]:
    figure = plan_picture(plan, LIBRARY, Mission("out", SE2.identity(), 1, (20.0, 10.0), 2.0))
    handles = figure.legends[0].legend_handles
    return {str(one.get_label()): one for one in handles if isinstance(one, Line2D)}


def test_the_legend_of_a_plan_has_every_level_and_each_trim_held_once() -> None:
    walk, times = (1, 2, 1, 3), (1.25, 0.0, 2.5, 0.004)
    scenarios = [Scenario(gamma, 10 - gamma, times, SE2.identity()) for gamma in (0.0, -1.0, 1.0)]
    plan = plan_of(walk, (4, 5, 6), tuple(scenarios))
    entries = legend(plan)
    name = LIBRARY.trim(1).name
    assert list(entries) == [
        "gamma -1, slowest: 11.00 s; maneuvers 4, 5, 6",
        f"trim 1, {name}: 1.25 + 2.50 s",
        "gamma 0: 10.00 s",
        "gamma 1: 9.00 s",
        "goal, within 2 m",
    ]
    colors = trim_colors(trim.id for trim in LIBRARY.trims)
    assert not {entries[level].get_color() for level in ("gamma 0: 10.00 s", "gamma 1: 9.00 s")} & set(
        colors.values()
    )


def test_the_legend_of_a_nominal_plan_has_no_level() -> None:
    only = Scenario(0.0, 3.0, (3.0,), SE2.identity())
    plan = plan_of((1,), (), (only,), policy="nominal")
    assert list(legend(plan)) == [f"trim 1, {LIBRARY.trim(1).name}: 3.00 s", "goal, within 2 m"]
