"""Tiles and facts of a flight's summary, as texts for the page."""

from collections.abc import Iterator

import numpy as np

from flight.plural import plural
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind
from flightlog.series import Series
from flightlog.topics import ACTUATORS, COMMAND, CONTROLS, ESTIMATE, MOTION, NAVIGATION, TRUTH, WIND

from .bound_check import BOUNDS_ATTACHMENT, IDENTIFICATION_KINDS
from .summary import Summary

Content = dict[str, object]

NO_BOUNDS = "a campaign has no bounds of its own; --library FILE sets some"
"""Reason why a campaign's flight is not checked."""

LABELS = {"forward": "forward speed", "side": "sideward speed", "yaw_rate": "yaw rate"}


def summary_tiles(summary: Summary) -> list[Content]:
    """Returns the tiles of a summary.

    A tile has a label, a value, a note, a tone (`good`, `bad`, `plain`) and a time that it links to.
    """
    tiles = [_outcome(summary)]
    if summary.planned_time is not None:
        tiles.append(_tile("planned time", f"{summary.planned_time:.2f} s", "mission as stated"))
    if summary.bounds is not None:
        left, checked = len(summary.bounds.violations), summary.bounds.coasts + summary.bounds.maneuvers
        coasts = summary.bounds.count_violations(PrimitiveKind.COAST)
        note = (
            f"{plural(coasts, 'coast')}, {plural(left - coasts, 'maneuver')}"
            if left
            else f"of library {summary.bounds.library}"
        )
        tone = "bad" if left else "good"
        tiles.append(_tile("left their bounds", f"{left} of {checked}", note, tone))
    elif summary.kind in IDENTIFICATION_KINDS:
        tiles.append(_tile("left their bounds", "not checked", NO_BOUNDS))
    if summary.trims or summary.maneuvers:
        tone = "bad" if summary.timeouts else "good"
        tiles.append(_tile("time-outs", str(summary.timeouts), "of maneuvers", tone))
    if summary.plans is not None:
        found, failed = summary.plans, summary.failures
        note = "no replan failed" if not failed else f"{plural(failed, 'replan')} failed"
        tiles.append(_tile("plans", str(found), note, "bad" if failed else "plain"))
    if summary.faults:
        tiles.append(_tile("faults", str(len(summary.faults)), "see the events", "bad"))
    if summary.tracking is not None:
        # Errors are compared in units of 1 m/s and 0.1 rad/s, which are of one order in flight.
        worst = max(summary.tracking, key=lambda error: abs(error.worst) * (10 if "rad" in error.unit else 1))
        scale, unit = (np.degrees(1.0), "deg/s") if "rad" in worst.unit else (1.0, worst.unit)
        tile = _tile(
            "largest tracking error",
            f"{scale * worst.worst:+.2f} {unit}",
            f"{LABELS[worst.field]}, at {worst.time:.1f} s",
            "plain",
        )
        tiles.append({**tile, "time": worst.time})
    if summary.navigation is not None:
        error = summary.navigation
        tiles.append(
            _tile(
                "navigation error", f"{error.position_rms:.2f} m", f"rms; {error.position_max:.2f} m at most"
            )
        )
    return tiles


def summary_facts(log: FlightLog, summary: Summary) -> list[tuple[str, str]]:
    """Returns names and values of further facts about a flight."""
    header = log.header
    facts = [("Duration", f"{summary.duration:.2f} s"), *_extreme_values(log.motion, summary)]
    if WIND.name in log.series:
        wind = log[WIND]
        speeds = np.hypot(wind["north"], wind["east"])
        facts.append(("Air over the ground", f"{speeds.mean():.2f} m/s mean, {speeds.max():.2f} m/s at most"))
    facts += [
        ("Vehicle", f"{header.vehicle}, model {header.model_hash[:12]}"),
        ("Program", f"{header.code_version}, {header.backend}"),
        ("Samples", _sampling(log)),
        ("Attachments", ", ".join(name for name in log.attachments if name != BOUNDS_ATTACHMENT) or "none"),
    ]
    return facts


def _extreme_values(motion: Series, summary: Summary) -> Iterator[tuple[str, str]]:
    """Yields the extremes of distance, speed, height, tilt and body rate."""
    if summary.distance is not None:
        yield "Distance over the ground", f"{summary.distance:.1f} m"
    if motion.has_fields("forward", "side"):
        speed = np.hypot(motion["forward"], motion["side"])
        yield "Speed over the ground", f"{np.nanmean(speed):.2f} m/s mean, {np.nanmax(speed):.2f} m/s at most"
    if motion.has_fields("down"):
        height = -motion["down"]
        origin = "ground" if summary.kind != "import" else "the log's origin"
        yield f"Height above {origin}", f"{np.nanmin(height):.2f} to {np.nanmax(height):.2f} m"
    if motion.has_fields("roll", "pitch"):
        tilt = np.arccos(np.clip(np.cos(motion["roll"]) * np.cos(motion["pitch"]), -1.0, 1.0))
        yield "Tilt", f"{np.degrees(np.nanmax(tilt)):.1f} deg at most"
    rates = ("roll_rate", "pitch_rate", "body_yaw_rate")
    if motion.has_fields(*rates):
        fastest = np.nanmax(np.linalg.norm([motion[name] for name in rates], axis=0))
        yield "Body rate", f"{np.degrees(fastest):.1f} deg/s at most"


def _sampling(log: FlightLog) -> str:
    """Returns each topic's sampling rate and the longest gap if uneven."""
    words = []
    for topic in (TRUTH, ESTIMATE, MOTION, COMMAND, NAVIGATION, CONTROLS, ACTUATORS, WIND):
        if topic.name in log.series and len(log[topic]) > 1:
            gaps = np.diff(log[topic].time)
            usual, longest = float(np.median(gaps)), float(gaps.max())
            word = f"{topic.name} {1.0 / usual:.0f} Hz" if usual > 0 else topic.name
            words.append(word + (f" (longest gap {longest:.2f} s)" if longest > 1.5 * usual else ""))
    return ", ".join(words)


def _outcome(summary: Summary) -> Content:
    if summary.outcome.startswith("recovered"):
        return _tile("outcome", "recovered", summary.outcome, "bad")
    if summary.outcome != "completed":
        return _tile("outcome", "lost", summary.outcome, "bad")
    if summary.kind == "import":
        return _tile("log", "imported", f"{summary.duration:.1f} s; outcome unknown")
    if summary.arrival is None:
        return _tile("outcome", "completed", f"{summary.duration:.1f} s", "good")
    if summary.arrival.time is None:
        return _tile("goal", "not reached", summary.arrival.reason, "bad")
    tile = _tile("goal", "reached", f"after {summary.arrival.time:.2f} s", "good")
    return {**tile, "time": summary.arrival.time}


def _tile(label: str, value: str, note: str, tone: str = "plain") -> Content:
    return {"label": label, "value": value, "note": note, "tone": tone, "time": None}
