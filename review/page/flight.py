"""Content of one flight on a page, as plain JSON values."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from flight.plan.planned_track import planned_track, planned_tube
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.events import flight_events
from flightlog.fault_record import fault_occurrences
from flightlog.log import FlightLog
from flightlog.mission_attachments import LoggedPlan, logged_goal, logged_plans
from flightlog.primitives import FlownPrimitive, PrimitiveKind, merged_primitives
from flightlog.series import Series
from flightlog.topics import ESTIMATE, PRIMITIVE, TRUTH, WIND
from flightlog.trim_labels import trim_label, trim_names, trim_palette
from flightlog.viewers.scene import estimated_pose, tube_gamma
from review.summary.bound_check import BoundDeviation, bounding_library, compute_deviations
from review.summary.summary import Summary
from review.summary.tiles import summary_facts, summary_tiles

from .columns import pack_floats
from .decimation import decimate

Content = dict[str, object]

MOST_TRACK_POINTS = 8000
MOST_PLANS = 60
"""Largest number of plans drawn; longer lists are thinned evenly."""

_UNITS = {
    PrimitiveKind.COAST: {"forward": "m/s", "side": "m/s", "yaw_rate": "deg/s"},
    PrimitiveKind.MANEUVER: {"duration": "s", "forward": "m", "side": "m", "heading change": "deg"},
}


def flight_page_content(log: FlightLog, summary: Summary, label: str) -> Content:
    """Returns a flight's content without its curves, as plain JSON values."""
    return {
        "label": label,
        "kind": summary.kind,
        "name": summary.name,
        "duration": log.duration,
        "library": None if summary.bounds is None else summary.bounds.library,
        "tiles": summary_tiles(summary),
        "facts": summary_facts(log, summary),
        "primitives": _primitives(log),
        "bands": _bands(log),
        "events": [
            {"time": event.time, "level": event.level.name, "source": event.source, "text": event.text}
            for event in flight_events(log)
        ],
        "faults": [
            {"start": flown.start, "end": flown.end, "text": f"{flown.fault.where} {flown.fault.what}"}
            for flown in fault_occurrences(log).values()
        ],
        "goal": _goal(log),
        "plans": _plans(log),
        "track": _track(log.motion),
        "estimated": _track(log[ESTIMATE]) if _has_estimate_and_truth(log) else None,
        "wind": _mean_wind(log),
    }


def _primitives(log: FlightLog) -> list[Content]:
    if PRIMITIVE.name not in log.series:
        return []
    names, colors = trim_names(log), trim_palette(log)
    judged: dict[tuple[PrimitiveKind, float], BoundDeviation] = {}
    library = bounding_library(log) if TRUTH.name in log.series else None
    if library is not None:
        judged = {(one.kind, one.start): one for one in compute_deviations(log, library)}
    return [
        {
            "kind": part.kind.name.lower(),
            "id": part.id,
            "name": _primitive_name(part, names),
            "from": part.from_trim,
            "to": part.to_trim,
            "color": colors.get(part.to_trim, "#8a8a8a"),
            "start": part.start,
            "end": part.end,
            "timedOut": part.timed_out,
            "judged": _deviation_content(judged.get((part.kind, part.start))),
        }
        for part in merged_primitives(log)
    ]


def _primitive_name(part: FlownPrimitive, names: dict[int, str]) -> str:
    if part.kind is PrimitiveKind.COAST:
        return trim_label(part.id, names)
    return f"{trim_label(part.from_trim, names)} to {trim_label(part.to_trim, names)}"


def _deviation_content(one: BoundDeviation | None) -> Content | None:
    if one is None:
        return None
    unit = _UNITS[one.kind][one.number]
    scale = np.degrees(1.0) if unit.startswith("deg") else 1.0
    return {
        "number": one.number.replace("_", " "),
        "unit": unit,
        "deviation": scale * one.deviation,
        "bound": scale * one.bound,
        "share": one.share,
        "left": one.exceeds_bound,
    }


def _bands(log: FlightLog) -> list[Content]:
    """Returns the velocity bounds of each coast, by the library's errors."""
    library = bounding_library(log)
    if library is None:
        return []
    bands = []
    for part in merged_primitives(log):
        if part.kind is PrimitiveKind.COAST:
            trim = library.trim(part.id)
            edges = {
                name: [
                    getattr(trim.velocity, name) - abs(getattr(trim.error, name)),
                    getattr(trim.velocity, name) + abs(getattr(trim.error, name)),
                ]
                for name in ("forward", "side", "yaw_rate")
            }
            bands.append({"start": part.start, "end": part.end, **edges})
    return bands


def _goal(log: FlightLog) -> Content | None:
    goal = logged_goal(log)
    if goal is None:
        return None
    return {"north": goal.position[0], "east": goal.position[1], "tolerance": goal.tolerance}


def _plans(log: FlightLog) -> list[Content]:
    """Returns plans with their tubes as lines from the estimated pose."""
    plans = logged_plans(log)
    if not plans or LIBRARY_ATTACHMENT not in log.attachments or ESTIMATE.name not in log.series:
        return []
    library = log.library()
    chosen = plans[:: -(-len(plans) // MOST_PLANS)]

    def content(planning: LoggedPlan) -> Content:
        plan, start = planning.plan, estimated_pose(log, planning.time)
        walk = (library, plan.sequence, plan.coasting_times)
        coasts, maneuvers = planned_track(*walk, start=start, gamma=plan.deciding.gamma)
        line = np.concatenate([piece for pair in _pair_with_maneuvers(coasts, maneuvers) for piece in pair])
        return {
            "time": planning.time,
            "cost": plan.cost,
            "policy": plan.policy,
            "sequence": list(plan.sequence),
            "level": tube_gamma(plan),
            "line": pack_floats(line),
            "tube": pack_floats(planned_tube(*walk, start=start, level=tube_gamma(plan))),
            "points": len(line),
        }

    return [content(plan) for plan in chosen]


def _pair_with_maneuvers(
    coasts: Sequence[np.ndarray], maneuvers: Sequence[np.ndarray]
) -> list[list[np.ndarray]]:
    """Pairs each coast with the maneuver that follows it."""
    return [[coast, *maneuvers[place : place + 1]] for place, coast in enumerate(coasts)]


def _has_estimate_and_truth(log: FlightLog) -> bool:
    return ESTIMATE.name in log.series and log.motion.topic.name != ESTIMATE.name


def _track(states: Series) -> Content | None:
    """Returns an evenly thinned track; None without positions."""
    if not states.has_fields("north", "east"):
        return None
    step = -(-len(states) // MOST_TRACK_POINTS)
    rows = np.unique([*range(0, len(states), step), len(states) - 1])
    return {
        "time": pack_floats(states.time[rows]),
        "north": pack_floats(states["north"][rows]),
        "east": pack_floats(states["east"][rows]),
        "height": pack_floats(-states["down"][rows]) if states.has_fields("down") else None,
        "heading": pack_floats(states["heading"][rows]) if states.has_fields("heading") else None,
    }


def _mean_wind(log: FlightLog) -> Content | None:
    if WIND.name not in log.series:
        return None
    wind = log[WIND]
    return {"north": float(wind["north"].mean()), "east": float(wind["east"].mean())}


def sparkline(time: Float[np.ndarray, "n"], values: Float[np.ndarray, "n"], *, points: int) -> list[float]:
    """Returns a curve of few points that keeps every extreme."""
    if len(time) == 0:
        return []
    _, kept = decimate(time, values[:, None], most=points)
    return [round(float(value), 4) for value in kept[:, 0]]
