"""Arrival verdict of a mission's log, carried in it or judged anew."""

import json
from bisect import bisect_right
from dataclasses import asdict

import numpy as np

from flight.mission.arrival import ArrivalVerdict, TrackSegment, judge_arrival
from flight.schema import parse_json

from .attachment_names import ARRIVAL_ATTACHMENT
from .decision import DECISION, DecisionKind
from .log import FlightLog
from .mission_attachments import logged_goal, logged_goal_trim
from .primitives import PrimitiveKind, flown_primitives
from .topics import PRIMITIVE, TRUTH

OFF_PLAN = (DecisionKind.FAILED, DecisionKind.LATE, DecisionKind.REFUSED, DecisionKind.FALLBACK)
"""Decisions after which arrival does not count, until a plan is adopted or kept."""

_ON_PLAN = (DecisionKind.ADOPTED, DecisionKind.KEPT)


def logged_arrival(log: FlightLog) -> ArrivalVerdict | None:
    """Returns the arrival verdict of a log; None without mission or truth.

    A log that carries a verdict is not judged anew: it was judged by `judge_arrival` on every true sample.

    Raises:
        BadFileError: an attachment is broken.
    """
    if ARRIVAL_ATTACHMENT in log.attachments:
        return parse_json(log.attachments[ARRIVAL_ATTACHMENT], ARRIVAL_ATTACHMENT, ArrivalVerdict)
    return judge_log(log)


def judge_log(log: FlightLog) -> ArrivalVerdict | None:
    """Judges a log by its true track, primitives and decisions.

    Where the log has no decisions the vehicle counts as having declared whatever it did.

    Raises:
        BadFileError: an attachment is broken.
    """
    goal = logged_goal(log)
    if goal is None or TRUTH.name not in log.series:
        return None
    declared = True
    if DECISION.name in log.series:
        declared = bool((log[DECISION]["kind"] == DecisionKind.ARRIVED).any())
    return judge_arrival(_segments(log), goal, trim=logged_goal_trim(log), declared=declared)


def arrival_text(verdict: ArrivalVerdict) -> bytes:
    """Returns a verdict as a log carries it."""
    return json.dumps(asdict(verdict), indent=1).encode()


def _segments(log: FlightLog) -> list[TrackSegment]:
    truth = log[TRUTH]
    track = np.column_stack([truth.time, *(truth[name] for name in ("north", "east", "heading"))])
    if PRIMITIVE.name not in log.series:
        return [TrackSegment(track, None)]
    segments = []
    for part in flown_primitives(log):
        rows = track[(truth.time >= part.start - 1e-9) & (truth.time <= part.end + 1e-9)]
        if len(rows):
            held = part.id if part.kind is PrimitiveKind.COAST else None
            segments.append(TrackSegment(rows, held, _is_on_plan(log, part.start)))
    return segments


def _is_on_plan(log: FlightLog, time: float) -> bool:
    """Returns True where the decisions leave the vehicle on a plan."""
    if DECISION.name not in log.series:
        return True
    decisions = log[DECISION]
    kinds = decisions["kind"][: bisect_right(decisions.time.tolist(), time + 1e-9)].astype(int).tolist()
    known = [kind for kind in kinds if kind in (*OFF_PLAN, *_ON_PLAN)]
    return not known or known[-1] in _ON_PLAN
