"""Comparison table of several flights."""

from collections.abc import Callable, Sequence

import numpy as np

from flight.plural import plural
from flightlog.primitives import PrimitiveKind
from review.summary.summary import Summary
from review.summary.tiles import LABELS

NOT_KNOWN = "-"


def comparison_rows(summaries: Sequence[Summary]) -> list[list[str]]:
    """Returns rows of a name and a value per flight.

    Rows without a value in any flight are left out.
    """
    rows: list[tuple[str, Callable[[Summary], str]]] = [
        ("outcome", lambda one: one.outcome),
        ("goal", _goal),
        ("planned time", _planned),
        ("plans, failed replans", _plans),
        ("duration", lambda one: f"{one.duration:.2f} s"),
        ("distance over the ground", _distance),
        ("wind class, seed", lambda one: NOT_KNOWN if one.kind == "import" else f"{one.wind}, {one.seed}"),
        ("primitives", lambda one: str(_primitives(one) or NOT_KNOWN)),
        ("left their bounds", _bounds),
        ("time-outs", lambda one: str(one.timeouts) if _primitives(one) else NOT_KNOWN),
        ("faults", lambda one: str(len(one.faults)) if one.faults else NOT_KNOWN),
        *((f"{LABELS[field]}: truth minus command", _tracking(field)) for field in LABELS),
        ("navigation: position", _navigation),
    ]
    filled = [[name, *(value(summary) for summary in summaries)] for name, value in rows]
    return [row for row in filled if any(value != NOT_KNOWN for value in row[1:])]


def _primitives(one: Summary) -> int:
    return sum(part.count for part in (*one.trims, *one.maneuvers))


def _goal(one: Summary) -> str:
    if one.arrival is None:
        return NOT_KNOWN
    if one.arrival.time is None:
        return f"not reached: {one.arrival.reason}"
    return f"reached after {one.arrival.time:.2f} s"


def _distance(one: Summary) -> str:
    return NOT_KNOWN if one.distance is None else f"{one.distance:.1f} m"


def _planned(one: Summary) -> str:
    return NOT_KNOWN if one.planned_time is None else f"{one.planned_time:.2f} s"


def _plans(one: Summary) -> str:
    return NOT_KNOWN if one.plans is None else f"{one.plans}, {one.failures}"


def _bounds(one: Summary) -> str:
    if one.bounds is None:
        return NOT_KNOWN
    coasts, maneuvers = (
        one.bounds.count_violations(kind) for kind in (PrimitiveKind.COAST, PrimitiveKind.MANEUVER)
    )
    checked = plural(one.bounds.coasts, "coast"), plural(one.bounds.maneuvers, "maneuver")
    return f"{coasts} of {checked[0]}, {maneuvers} of {checked[1]}"


def _tracking(field: str) -> Callable[[Summary], str]:
    def value(one: Summary) -> str:
        for error in one.tracking or ():
            if error.field == field:
                scale, unit = (np.degrees(1.0), "deg/s") if "rad" in error.unit else (1.0, error.unit)
                return f"{scale * error.rms:.2f} {unit} rms, {scale * abs(error.worst):.2f} at most"
        return NOT_KNOWN

    return value


def _navigation(one: Summary) -> str:
    if one.navigation is None:
        return NOT_KNOWN
    return f"{one.navigation.position_rms:.2f} m rms, {one.navigation.position_max:.2f} m at most"
