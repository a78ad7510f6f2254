"""Events of a flight by time: primitives, replans, goal and end."""

from dataclasses import dataclass
from enum import IntEnum

from flight.errors import FlightError

from .alarm import ADVICE, ALARM, alarms_from_series
from .arrival import logged_arrival
from .autopilot_messages import autopilot_messages
from .fault_record import fault_occurrences
from .log import FlightLog
from .mission_attachments import logged_goal, logged_plannings
from .motion.continuity import logged_breaks
from .primitives import FlownPrimitive, PrimitiveKind, merged_primitives
from .topics import PRIMITIVE
from .trim_labels import trim_label, trim_names


class Level(IntEnum):
    """Severity of an event, named and numbered as in `foxglove.Log`."""

    INFO = 2
    WARNING = 3
    ERROR = 4


@dataclass(frozen=True, slots=True)
class Event:
    """One event of a flight.

    Attributes:
        time: seconds since the flight's start.
        level: severity.
        source: `primitive`, `plan`, `fault`, `alarm`, `goal`, `log`, `flight` or `autopilot` (imported logs).
        text: one line.
    """

    time: float
    level: Level
    source: str
    text: str


def flight_events(log: FlightLog) -> tuple[Event, ...]:
    """Returns the events of a flight by time, with its broken attachments."""
    events: list[Event] = []
    for part in (_primitives, _plannings, _faults, _alarms, _autopilot_messages, _breaks, _arrival):
        try:
            events += part(log)
        except FlightError as error:
            events.append(Event(0.0, Level.ERROR, "log", str(error)))
    if log.header.outcome != "completed":
        events.append(Event(log.duration, Level.ERROR, "flight", log.header.outcome))
    return tuple(sorted(events, key=lambda event: event.time))


def _primitives(log: FlightLog) -> list[Event]:
    if PRIMITIVE.name not in log.series:
        return []
    names, events = trim_names(log), []
    for part in merged_primitives(log):
        events.append(Event(part.start, Level.INFO, "primitive", _sentence(part, names)))
        if part.timed_out:
            text = f"maneuver {part.id} ended by time-out after {part.end - part.start:.2f} s"
            events.append(Event(part.end, Level.WARNING, "primitive", text))
    return events


def _sentence(part: FlownPrimitive, names: dict[int, str]) -> str:
    if part.kind is PrimitiveKind.COAST:
        return f"hold {trim_label(part.id, names)}"
    return f"maneuver {part.id}: {trim_label(part.from_trim, names)} to {trim_label(part.to_trim, names)}"


def _plannings(log: FlightLog) -> list[Event]:
    events = []
    for number, planning in enumerate(logged_plannings(log), start=1):
        plan = planning.plan
        if plan.found:
            walk = " ".join(map(str, plan.sequence))
            how = f"({plan.policy}, {plan.status})"
            text = f"plan {number}: {plan.cost:.2f} s through trims {walk} {how}"
            events.append(Event(planning.time, Level.INFO, "plan", text))
        else:
            why = plan.reason or "no reason given"
            events.append(Event(planning.time, Level.WARNING, "plan", f"plan {number}: none; {why}"))
    return events


def _faults(log: FlightLog) -> list[Event]:
    return [
        Event(occurrence.start, Level.WARNING, "fault", f"fault {number}: {occurrence.sentence}")
        for number, occurrence in fault_occurrences(log).items()
    ]


def _autopilot_messages(log: FlightLog) -> list[Event]:
    events = []
    for message in autopilot_messages(log):
        level = Level[message.level] if message.level in Level.__members__ else Level.INFO
        earlier = f"{-message.time:.1f} s before the start: " if message.time < 0.0 else ""
        time = min(max(message.time, 0.0), log.duration)
        events.append(Event(time, level, "autopilot", earlier + message.text))
    return events


def _breaks(log: FlightLog) -> list[Event]:
    return [Event(each.time, Level.WARNING, "log", each.reason) for each in logged_breaks(log)]


def _alarms(log: FlightLog) -> list[Event]:
    if ALARM.name not in log.series:
        return []
    alarms = alarms_from_series(log[ALARM])
    return [
        Event(
            alarm.time,
            Level.WARNING if alarm.kind in ADVICE else Level.ERROR,
            "alarm",
            alarm.sentence,
        )
        for alarm in alarms
    ]


def _arrival(log: FlightLog) -> list[Event]:
    goal, met = logged_goal(log), logged_arrival(log)
    if goal is None or met is None:
        return []
    if met.time is None:
        return [Event(log.duration, Level.WARNING, "goal", f"goal not reached: {met.reason}")]
    return [Event(met.time, Level.INFO, "goal", f"goal reached, within {goal.tolerance:.3g} m")]
