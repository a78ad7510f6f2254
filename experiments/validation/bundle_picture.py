"""Picture of open-loop plans in worlds with different errors."""

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import Bbox

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flight.plan.planned_track import planned_track
from review.pictures import palette
from review.pictures.marks import annotate_pose, draw_goal, draw_heading_marker
from review.pictures.stroke import Stroke

from .flight_style import MANEUVERED

LEVELS = (
    ("nominal", 0.0, palette.ALARM),
    ("all errors subtracted", -1.0, palette.GOAL),
    ("all errors added", 1.0, palette.TRUE_COLOR),
)


def bundle_picture(
    mission: Mission, library: Library, plans: Mapping[str, Plan], worlds: Sequence[Library], *, gamma: float
) -> Figure:
    """Returns a panel per policy with its plan in all worlds.

    Args:
        mission: mission of the plans.
        library: library of the plans.
        plans: plans by policy.
        worlds: libraries with the same primitives and other values, drawn faintly.
        gamma: gamma of the two strong lines beside the plan.
    """
    figure = palette.new_figure(5.6 * max(len(plans), 1), 6.0)
    panels = figure.subplots(1, max(len(plans), 1), squeeze=False)[0]
    handles: list[Line2D] = []
    for axes, (policy, plan) in zip(panels, plans.items(), strict=False):
        palette.format_axes(axes)
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_xlabel("east, m", fontsize=palette.TEXT_SIZE)
        walk = " ".join(map(str, plan.sequence)) or "none"
        palette.draw_headline(axes, f"{mission.name}, {policy}, open loop: trims {walk}")
        handles = _draw(axes, mission, library, plan, worlds=worlds, gamma=gamma)
    everything = Bbox.union([axes.dataLim for axes in panels])
    for axes in panels:
        axes.update_datalim(everything.corners())
        axes.margins(0.08)
        axes.autoscale_view()
    panels[0].set_ylabel("north, m", fontsize=palette.TEXT_SIZE)
    figure.legend(
        handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=palette.SMALL_TEXT + 0.5
    )
    return figure


def _draw(
    axes: Axes, mission: Mission, library: Library, plan: Plan, *, worlds: Sequence[Library], gamma: float
) -> list[Line2D]:
    handles = [draw_goal(axes, mission.destination)]
    if plan.found:
        times = plan.deciding.coasting_times
        faint = Stroke(palette.FAINT, 0.7, opacity=0.35, layer=2.0)
        for world in worlds:
            coasts, maneuvers = planned_track(world, plan.sequence, times, start=mission.start)
            for line in (*coasts, *maneuvers):
                faint.draw(axes, line[:, 1], line[:, 0])
            axes.plot(coasts[-1][-1, 1], coasts[-1][-1, 0], ".", color=palette.INK, markersize=3, zorder=3)
        for words, sign, color in LEVELS:
            _draw_level(axes, mission, library, plan, gamma=sign * gamma, color=color)
            handles.append(Stroke(color, 1.8).entry(f"gamma {sign * gamma:+g}: {words}"))
        handles.append(faint.entry(f"{len(worlds)} worlds with independent errors of every primitive"))
    draw_heading_marker(axes, mission.start, fill=palette.INK)
    annotate_pose(axes, mission.start, "start", away=-1.2)
    return handles


def _draw_level(
    axes: Axes, mission: Mission, library: Library, plan: Plan, *, gamma: float, color: str
) -> None:
    times = plan.deciding.coasting_times
    coasts, maneuvers = planned_track(library, plan.sequence, times, start=mission.start, gamma=gamma)
    for line in coasts:
        Stroke(color, 1.8, layer=5.0).draw(axes, line[:, 1], line[:, 0])
    for line in maneuvers:
        Stroke(color, 1.8, dashes=MANEUVERED, layer=5.0).draw(axes, line[:, 1], line[:, 0])
