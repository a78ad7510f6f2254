"""Demo picture: plans with their tracks, flights by outcome."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure

from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from flight.plan.planned_track import planned_track
from flight.se2 import SE2
from flightlog.log import FlightLog
from flightlog.topics import TRUTH
from review.pictures.demo_picture import (
    FLOWN,
    MISSED,
    OTHER_SCENARIO,
    PLANNED,
    FlownPlan,
    demo_picture,
    outcome_caption,
)
from review.pictures.stroke import Stroke
from tests.support.altered_logs import bound_for
from tests.support.reviewed_flights import COASTS, LIBRARY, WALK, plan_of, whole_flight

FLIGHT = whole_flight()
START = SE2(5.0, -3.0, 0.7)


def plan_at(*gammas: float) -> Plan:
    scenarios = tuple(Scenario(gamma, 20.0 - gamma, COASTS, SE2.identity()) for gamma in gammas)
    ids = tuple(maneuver.id for maneuver in LIBRARY.maneuvers_along(WALK))
    return plan_of(WALK, ids, scenarios, status="feasible")


def drawn(axes: Axes, stroke: Stroke) -> list[np.ndarray]:
    """Returns the lines of a look, without the entries of the legend."""
    return [
        np.asarray(line.get_xydata())
        for line in axes.lines
        if (to_rgba(line.get_color()), line.get_linewidth()) == (to_rgba(stroke.color), stroke.width)
        and line.get_alpha() == stroke.opacity
    ]


def maps(figure: Figure) -> list[Axes]:
    return [axes for axes in figure.findobj(Axes) if axes.get_xlabel() == "east, m"]


def end_of(log: FlightLog) -> tuple[float, float]:
    return float(log[TRUTH]["north"][-1]), float(log[TRUTH]["east"][-1])


def test_the_whole_way_is_drawn_with_and_without_a_plan(tmp_path: Path) -> None:
    mission = Mission("there", START, 1, end_of(FLIGHT), 2.0)
    flight = bound_for(FLIGHT, end_of(FLIGHT), 2.0)
    elsewhere = bound_for(whole_flight(coasts=(0.5,) * 4, seed=2), end_of(FLIGHT), 2.0)
    none = plan_of((), (), (), status="infeasible", policy="nominal", reason="every walk ends elsewhere")
    outcomes = [FlownPlan(none, ()), FlownPlan(plan_at(0.0, -1.0, 1.0), (flight, elsewhere))]
    figure = demo_picture(LIBRARY, mission, outcomes)
    figure.savefig(tmp_path / "demo.png")
    without, planned = maps(figure)
    assert [len(drawn(without, stroke)) for stroke in (PLANNED, OTHER_SCENARIO, FLOWN, MISSED)] == [0] * 4
    assert [len(drawn(planned, stroke)) for stroke in (PLANNED, OTHER_SCENARIO, FLOWN, MISSED)] == [
        1,
        2,
        1,
        1,
    ]
    # The slowest case is the plan's, and leads where the automaton leads; east is to the right.
    coasts, _ = planned_track(LIBRARY, WALK, COASTS, start=START, gamma=-1.0)
    (slowest,) = drawn(planned, PLANNED)
    np.testing.assert_allclose(slowest[[0, -1], ::-1], [coasts[0][0], coasts[-1][-1]])
    (missed,) = drawn(planned, MISSED)
    np.testing.assert_allclose(missed[-1, ::-1], end_of(elsewhere))
    titles = [axes.get_title("left") for axes in (without, planned)]
    assert titles == ["2  Nominal plan, flown 0 times", "3  Worst-case plan, flown 2 times"]
    legends = [axes.get_legend() for axes in (without, planned)]
    assert [legend and legend.get_title().get_text().split("\n")[0] for legend in legends] == [
        "no plan: infeasible",
        "planned 21.0 s, maximum over gamma 0 and \N{PLUS-MINUS SIGN}1",
    ]


def test_the_caption_states_the_planned_time_and_the_results() -> None:
    plan = plan_at(0.0, -1.0)
    assert outcome_caption(plan, [FLIGHT], [None]).endswith("goal reached in 0 of 1 flight")
    planned, results = outcome_caption(plan, [FLIGHT, FLIGHT], [17.3, None]).split("\n")
    assert planned == "planned 21.0 s, maximum over gamma 0 and \N{PLUS-MINUS SIGN}1"
    assert results == "goal reached in 1 of 2 flights, in 17.3 s"
    nothing = replace(plan, status="unknown", scenarios=(), reason="no coasting times were found")
    assert outcome_caption(nothing, [], []) == "no plan: unknown\nno coasting times were found"
