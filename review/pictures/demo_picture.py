"""Picture of the workflow: identified library, plans, and their flights."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from flight.plan.planned_track import planned_track
from flight.se2 import SE2
from flightlog.arrival import logged_arrival
from flightlog.log import FlightLog
from flightlog.topics import TRUTH

from . import palette
from .automaton_picture import draw_automaton
from .library_picture import draw_trim_errors
from .marks import annotate_pose, draw_goal, draw_heading_marker
from .stroke import COMMAND_DASHES, Stroke

PLANNED = Stroke(palette.INK, 1.2, dashes=COMMAND_DASHES, layer=3.0)
OTHER_SCENARIO = Stroke(palette.FAINT, 0.9, dashes=COMMAND_DASHES, layer=2.5)
FLOWN = Stroke(palette.TRUE_COLOR, 2.0, opacity=0.75)
FLOWN_AFTER_GOAL = Stroke(palette.TRUE_COLOR, 0.9, opacity=0.35)
MISSED = Stroke(palette.ALARM, 2.0, opacity=0.85)

POLICY_NAMES = {"nominal": "Nominal plan", "worst-case": "Worst-case plan"}


@dataclass(frozen=True, slots=True, eq=False)
class FlownPlan:
    """A plan with its flights, which replan on the way."""

    plan: Plan
    flights: tuple[FlightLog, ...]


def demo_picture(library: Library, mission: Mission, outcomes: Sequence[FlownPlan]) -> Figure:
    """Returns the picture of library, plans and flights.

    Args:
        library: library of the plans.
        mission: mission of the plans.
        outcomes: one per policy.
    """
    figure = palette.new_figure(7.0 + 5.0 * len(outcomes), 8.6)
    conditions = library.conditions
    figure.suptitle(
        f"Identified library, plans and flights    |    {library.vehicle}, wind {conditions.wind}, "
        f"mission {mission.name}",
        x=0.01,
        ha="left",
        fontsize=palette.TEXT_SIZE + 4,
        fontweight="bold",
    )
    columns = figure.add_gridspec(1, 2, width_ratios=(6.0, 5.0 * len(outcomes)))
    left = columns[0].subgridspec(2, 1, height_ratios=(0.6, 0.4))
    graph = figure.add_subfigure(left[0]).subplots()
    palette.draw_headline(
        graph, f"1  Identified: {len(library.trims)} trims, {len(library.maneuvers)} maneuvers"
    )
    draw_automaton(graph, library, tall=1.25)
    draw_trim_errors(figure.add_subfigure(left[1]), library)
    right = figure.add_subfigure(columns[1])
    maps = right.subplots(1, len(outcomes), squeeze=False)[0]
    for number, (axes, outcome) in enumerate(zip(maps, outcomes, strict=True), start=2):
        _draw_outcome(axes, library, mission, outcome, number=number)
    # Equal scales, so that the tracks can be compared.
    everything = Bbox.union([axes.dataLim for axes in maps])
    for axes in maps:
        axes.update_datalim(everything.corners())
        axes.autoscale_view()
    maps[0].set_ylabel("north, m", fontsize=palette.TEXT_SIZE)
    return figure


def _draw_outcome(axes: Axes, library: Library, mission: Mission, outcome: FlownPlan, *, number: int) -> None:
    palette.format_axes(axes)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("east, m", fontsize=palette.TEXT_SIZE)
    plan = outcome.plan
    for scenario in plan.scenarios:
        _draw_scenario(axes, library, mission, plan, scenario)
    verdicts = [logged_arrival(log) for log in outcome.flights]
    arrivals = [None if verdict is None else verdict.time for verdict in verdicts]
    for log, arrival in zip(outcome.flights, arrivals, strict=True):
        style = MISSED if arrival is None else FLOWN
        truth = log[TRUTH]
        way = truth.time <= (log.duration if arrival is None else arrival)
        style.draw(axes, truth["east"][way], truth["north"][way])
        FLOWN_AFTER_GOAL.draw(axes, truth["east"][~way], truth["north"][~way])
    _draw_start_and_goal(axes, mission)
    axes.margins(0.15)
    title = POLICY_NAMES.get(plan.policy, f"Plan, {plan.policy}")
    palette.draw_headline(axes, f"{number}  {title}, flown {_times_phrase(len(outcome.flights))}")
    axes.legend(
        handles=_entries(plan, arrivals),
        loc="upper left",
        bbox_to_anchor=(0.0, -0.09),
        borderaxespad=0.0,
        frameon=False,
        fontsize=palette.TEXT_SIZE,
        title=outcome_caption(plan, outcome.flights, arrivals),
        alignment="left",
        title_fontsize=palette.TEXT_SIZE + 0.5,
    )


def outcome_caption(plan: Plan, flights: Sequence[FlightLog], arrivals: Sequence[float | None]) -> str:
    """Returns planned time and results of a plan in two lines."""
    if not plan.found:
        return f"no plan: {plan.status}\n{plan.reason}"
    planned = f"planned {plan.cost:.1f} s"
    if len(plan.scenarios) > 1:
        planned += f", maximum over gamma 0 and \N{PLUS-MINUS SIGN}{plan.gamma:g}"
    if not flights:
        return f"{planned}\nnot flown"
    times = sorted(time for time in arrivals if time is not None)
    reached = f"goal reached in {len(times)} of {_plural(len(flights), 'flight')}"
    span = dict.fromkeys(f"{time:.1f} s" for time in (*times[:1], *times[-1:]))
    return f"{planned}\n{reached}{', in ' if span else ''}{' to '.join(span)}"


def _draw_scenario(axes: Axes, library: Library, mission: Mission, plan: Plan, scenario: Scenario) -> None:
    coasts, maneuvers = planned_track(
        library, plan.sequence, scenario.coasting_times, start=mission.start, gamma=scenario.gamma
    )
    lines = [line for pair in zip(coasts, (*maneuvers, coasts[-1][-1:]), strict=True) for line in pair]
    track = np.concatenate(lines)
    style = PLANNED if scenario == plan.deciding else OTHER_SCENARIO
    style.draw(axes, track[:, 1], track[:, 0])


def _draw_start_and_goal(axes: Axes, mission: Mission) -> None:
    north, east = mission.goal
    draw_goal(axes, mission.destination)
    draw_heading_marker(axes, mission.start, fill=palette.INK)
    annotate_pose(axes, mission.start, "start", away=-1.2, along=True)
    annotate_pose(axes, SE2(north, east, 0.0), "goal", along=True)


def _entries(plan: Plan, arrivals: Sequence[float | None]) -> list[Line2D]:
    entries = []
    if plan.found:
        entries.append(PLANNED.entry("planned" if len(plan.scenarios) == 1 else "planned, slowest scenario"))
    if len(plan.scenarios) > 1:
        entries.append(OTHER_SCENARIO.entry("planned, other scenarios"))
    if any(time is not None for time in arrivals):
        entries.append(FLOWN.entry("flown, goal reached"))
        entries.append(FLOWN_AFTER_GOAL.entry("flown, after reaching the goal"))
    if None in arrivals:
        entries.append(MISSED.entry("flown, goal missed"))
    return entries


def _times_phrase(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _plural(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
