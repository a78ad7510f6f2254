"""Plan view of closed-loop flights and plans of several policies."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flight.plan.planned_track import planned_track
from review.pictures import palette
from review.pictures.marks import annotate_pose, draw_goal, draw_heading_marker
from review.pictures.palette import format_map_axes
from review.pictures.stroke import Stroke

from .flight_style import MANEUVERED, FlightTrack, draw_flight, policies_of, policy_color


def closed_loop_picture(
    mission: Mission,
    library: Library,
    plans: Mapping[str, Plan],
    flights: Sequence[FlightTrack],
    *,
    title: str,
) -> Figure:
    """Returns the picture of one mission, north up, with equal scales.

    Args:
        mission: the mission.
        library: library of the plans.
        plans: plan at the start by policy; drawn broad and pale.
        flights: flights; the first of each policy is drawn strong, the others thin.
        title: title of the picture.
    """
    figure = palette.new_figure(7.6, 6.6)
    axes = figure.add_subplot()
    format_map_axes(axes)
    palette.draw_headline(axes, title)
    handles: list[Line2D] = []
    for policy in policies_of(flights):
        flown = [flight for flight in flights if flight.policy == policy]
        plan = plans.get(policy)
        if plan is not None and plan.found:
            stroke = Stroke(policy_color(policy), 7.0, opacity=0.16, layer=1.0)
            _draw_plan(figure, stroke, plan, library, mission)
            handles.append(stroke.entry(f"{policy}: planned, {plan.cost:.1f} s"))
        for place, flight in enumerate(reversed(flown)):
            first = place == len(flown) - 1
            draw_flight(axes, flight, width=2.0 if first else 0.8, opacity=1.0 if first else 0.45)
        handles.append(Stroke(policy_color(policy), 2.0).entry(_arrival_label(policy, flown)))
    handles.append(Stroke(palette.INK, 1.4).entry("coast"))
    handles.append(Stroke(palette.INK, 1.4, dashes=MANEUVERED).entry("maneuver"))
    handles.append(draw_goal(axes, mission.destination))
    draw_heading_marker(axes, mission.start, fill=palette.INK)
    annotate_pose(axes, mission.start, "start", away=-1.2)
    axes.margins(0.08)
    figure.legend(
        handles=handles, loc="outside lower center", ncols=2, frameon=False, fontsize=palette.SMALL_TEXT + 0.5
    )
    return figure


def _draw_plan(figure: Figure, stroke: Stroke, plan: Plan, library: Library, mission: Mission) -> None:
    scenario = plan.deciding
    coasts, maneuvers = planned_track(
        library, plan.sequence, scenario.coasting_times, start=mission.start, gamma=scenario.gamma
    )
    for line in (*coasts, *maneuvers):
        stroke.draw(figure.axes[0], line[:, 1], line[:, 0])


def _arrival_label(policy: str, flown: Sequence[FlightTrack]) -> str:
    times = sorted(flight.flown_time for flight in flown if flight.reached)
    if not times:
        return f"{policy}: flown, goal reached in 0 of {len(flown)}"
    span = f"{times[0]:.1f} s" if len(times) == 1 else f"{times[0]:.1f} to {times[-1]:.1f} s"
    return f"{policy}: flown, goal reached in {len(times)} of {len(flown)}, {span}"
