"""Plan view of a plan: coasts, maneuvers, track of every scenario."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from flight.plan.planned_track import Line, planned_track
from flightlog.trim_labels import trim_colors

from . import palette
from .marks import annotate_pose, draw_goal, draw_heading_marker
from .palette import format_map_axes
from .stroke import Stroke

SHORTEST_SHOWN_COAST = 0.005
"""Shortest coast in seconds that is drawn; a shorter one would be written 0.00 s."""

DECIDING = Stroke(palette.INK, 1.3, layer=4.5)

# Greys with different dots, because the colours stand for trims.
AT_ZERO = Stroke(palette.FAINT, 1.2, layer=3.5)
ABOVE = Stroke(palette.FAINT, 1.6, dashes=(0.0, (1.0, 1.0)), layer=3.5)
BELOW = Stroke(palette.FAINT, 1.6, dashes=(0.0, (1.0, 3.0)), layer=3.5)


class NothingToDrawError(FlightError):
    """The plan found no solution, so there is no track to draw."""

    def __init__(self, plan: Plan) -> None:
        super().__init__(
            f"cannot draw the plan for {plan.mission}: expected a solution, got status {plan.status}"
        )


def plan_picture(plan: Plan, library: Library, mission: Mission) -> Figure:
    """Returns the picture of a plan: north up, east right, equal scales.

    The deciding scenario is drawn in the colours of its trims, the others in grey.

    Args:
        plan: the plan.
        library: library of the plan.
        mission: mission of the plan.

    Raises:
        NothingToDrawError: the plan has no solution.
    """
    if not plan.found:
        raise NothingToDrawError(plan)
    figure = palette.new_figure(7.6, 6.4)
    axes = figure.add_subplot()
    format_map_axes(axes)
    walk = " - ".join(str(trim) for trim in plan.sequence)
    palette.draw_headline(axes, f"{plan.mission}, {_guarantee_text(plan)}: trims {walk}")
    handles = _draw_scenarios(axes, plan, library, mission)
    handles.append(draw_goal(axes, mission.destination))
    draw_heading_marker(axes, mission.start, fill=palette.INK)
    annotate_pose(axes, mission.start, "start", away=-1.2, along=True)
    axes.margins(0.1)
    figure.legend(
        handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=palette.SMALL_TEXT
    )
    return figure


def _guarantee_text(plan: Plan) -> str:
    if plan.policy == "nominal":
        return f"nominal, {plan.cost:.2f} s"
    return f"{plan.policy} to gamma {plan.gamma:g}, {plan.cost:.2f} s (at gamma {plan.deciding.gamma:g})"


def _draw_scenarios(axes: Axes, plan: Plan, library: Library, mission: Mission) -> list[Line2D]:
    handles = _draw_deciding(axes, plan, library, mission)
    for scenario in plan.scenarios:
        if scenario is not plan.deciding:
            handles.append(_draw_faint(axes, plan, scenario, library, mission))
    return handles


def _draw_deciding(axes: Axes, plan: Plan, library: Library, mission: Mission) -> list[Line2D]:
    scenario = plan.deciding
    coasts, maneuvers = planned_track(
        library, plan.sequence, scenario.coasting_times, start=mission.start, gamma=scenario.gamma
    )
    colors = trim_colors(trim.id for trim in library.trims)
    held: dict[int, list[float]] = {}
    for trim, line, time in zip(plan.sequence, coasts, scenario.coasting_times, strict=True):
        if time >= SHORTEST_SHOWN_COAST:
            _draw(axes, _coast_stroke(colors[trim]), line)
            held.setdefault(trim, []).append(time)
    for line in maneuvers:
        _draw(axes, DECIDING, line)
    level = f"gamma {scenario.gamma:g}, slowest: {scenario.cost:.2f} s" if len(plan.scenarios) > 1 else ""
    steps = f"maneuvers {', '.join(map(str, plan.maneuvers))}" if maneuvers else ""
    entries = [DECIDING.entry("; ".join(filter(None, (level, steps))))] if level or steps else []
    for trim, times in held.items():
        seconds = " + ".join(f"{time:.2f}" for time in times)
        entries.append(
            _coast_stroke(colors[trim]).entry(f"trim {trim}, {library.trim(trim).name}: {seconds} s")
        )
    return entries


def _draw_faint(axes: Axes, plan: Plan, scenario: Scenario, library: Library, mission: Mission) -> Line2D:
    coasts, maneuvers = planned_track(
        library, plan.sequence, scenario.coasting_times, start=mission.start, gamma=scenario.gamma
    )
    style = BELOW if scenario.gamma < 0 else ABOVE if scenario.gamma > 0 else AT_ZERO
    for line in (*coasts, *maneuvers):
        _draw(axes, style, line)
    return style.entry(f"gamma {scenario.gamma:g}: {scenario.cost:.2f} s")


def _coast_stroke(color: str) -> Stroke:
    return Stroke(color, 3.0, layer=5.0)


def _draw(axes: Axes, style: Stroke, line: Line) -> None:
    style.draw(axes, line[:, 1], line[:, 0])
