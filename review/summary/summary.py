"""Summary of a flight: primitives, tracking, navigation, bounds, plans, arrival."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.mission.arrival import ArrivalVerdict
from flightlog.arrival import logged_arrival
from flightlog.attachment_names import PLANS_ATTACHMENT
from flightlog.fault_record import fault_occurrences
from flightlog.log import FlightLog
from flightlog.mission_attachments import logged_planned_time, logged_plannings
from flightlog.primitives import FlownPrimitive, PrimitiveKind, merged_primitives
from flightlog.series import Series
from flightlog.topics import COMMAND, ESTIMATE, PRIMITIVE, TRUTH
from flightlog.trim_labels import trim_names

from .bound_check import BoundCheck, check_bounds
from .tracking import VELOCITIES, navigation_error, tracking_error

Column = Float[np.ndarray, "n"]


@dataclass(frozen=True, slots=True)
class PrimitiveCount:
    """Flights of one primitive: id, name, count, total seconds."""

    id: int
    name: str
    count: int
    seconds: float


@dataclass(frozen=True, slots=True)
class TrackingError:
    """Truth minus command of one velocity.

    Attributes:
        field: `forward`, `side` or `yaw_rate`.
        unit: unit of the numbers.
        worst: the largest error, signed.
        time: time of the largest error, seconds since the flight's start.
        rms: root mean square over the flight.
    """

    field: str
    unit: str
    worst: float
    time: float
    rms: float


@dataclass(frozen=True, slots=True)
class NavigationError:
    """Estimate minus truth in the horizontal plane: metres, metres per second, radians.

    Attributes:
        position_rms: root mean square of the distance between the two positions.
        position_max: the largest distance.
        velocity_rms: root mean square length of the velocity difference.
        heading_rms: root mean square of the heading difference.
    """

    position_rms: float
    position_max: float
    velocity_rms: float
    heading_rms: float


@dataclass(frozen=True, slots=True)
class Summary:
    """Summary of a flight; a value missing in the log is None.

    Attributes:
        kind: `sequence`, `campaign` or `mission`.
        name: name of the sequence, campaign or mission.
        vehicle: the vehicle's name.
        seed: seed of the flight's random numbers.
        wind: wind class.
        duration: seconds.
        distance: length of the track over the ground, m: true, or else estimated; None without positions.
        outcome: `completed`, or the failure.
        trims: coasts flown, by trim.
        maneuvers: maneuvers flown, by id.
        timeouts: maneuvers that ended by time-out.
        tracking: one error per velocity that a trim fixes; None without command or truth.
        navigation: None without estimate or truth.
        bounds: None without library, truth or primitives.
        faults: injected faults with their times and sizes, a sentence each.
        plans: replans that found a plan; None where the log has no plans.
        failures: replans that found none, so that the previous plan stayed in force.
        planned_time: seconds of the plan for the mission as stated; None where the log carries none.
        arrival: None without a mission.
    """

    kind: str
    name: str
    vehicle: str
    seed: int
    wind: str
    duration: float
    distance: float | None
    outcome: str
    trims: tuple[PrimitiveCount, ...]
    maneuvers: tuple[PrimitiveCount, ...]
    timeouts: int
    tracking: tuple[TrackingError, ...] | None
    navigation: NavigationError | None
    bounds: BoundCheck | None
    faults: tuple[str, ...]
    plans: int | None
    failures: int
    planned_time: float | None
    arrival: ArrivalVerdict | None


def summarise(log: FlightLog) -> Summary:
    """Returns the summary of a flight.

    Raises:
        FlightError: the log has neither truth nor estimate, or an attachment is broken.
    """
    header = log.header
    flown = merged_primitives(log) if PRIMITIVE.name in log.series else ()
    names = trim_names(log)
    plannings = logged_plannings(log)
    plans = [planning.plan for planning in plannings if planning.plan.found]
    motion, true = log.motion, TRUTH.name in log.series
    return Summary(
        kind=header.kind,
        name=header.name,
        vehicle=header.vehicle,
        seed=header.seed,
        wind=header.wind,
        duration=log.duration,
        distance=_distance(motion),
        outcome=header.outcome,
        trims=_counts(flown, PrimitiveKind.COAST, lambda part: names.get(part.id, "")),
        maneuvers=_counts(
            flown,
            PrimitiveKind.MANEUVER,
            lambda part: f"{_trim_label(part.from_trim, names)} to {_trim_label(part.to_trim, names)}",
        ),
        timeouts=sum(part.timed_out for part in flown),
        tracking=_tracking(log) if true and COMMAND.name in log.series else None,
        navigation=_navigation(log) if true and _navigates(log) else None,
        bounds=check_bounds(log) if true and PRIMITIVE.name in log.series else None,
        faults=tuple(f"{flown.start:.2f} s: {flown.sentence}" for flown in fault_occurrences(log).values()),
        plans=len(plans) if PLANS_ATTACHMENT in log.attachments else None,
        failures=len(plannings) - len(plans),
        planned_time=logged_planned_time(log),
        arrival=logged_arrival(log),
    )


def _distance(motion: Series) -> float | None:
    if not motion.has_fields("north", "east"):
        return None
    # Imported positions may have holes.
    known = np.isfinite(motion["north"]) & np.isfinite(motion["east"])
    return float(np.hypot(np.diff(motion["north"][known]), np.diff(motion["east"][known])).sum())


def _navigates(log: FlightLog) -> bool:
    """Returns True if truth and estimate both have the fields to compare."""
    needed = ("north", "east", "forward", "side", "heading")
    return all(topic.name in log.series and log[topic].has_fields(*needed) for topic in (TRUTH, ESTIMATE))


def _trim_label(trim: int, names: dict[int, str]) -> str:
    return names.get(trim, f"trim {trim}")


def _counts(
    flown: tuple[FlownPrimitive, ...], kind: PrimitiveKind, name: Callable[[FlownPrimitive], str]
) -> tuple[PrimitiveCount, ...]:
    groups: dict[int, list[FlownPrimitive]] = {}
    for part in flown:
        if part.kind is kind:
            groups.setdefault(part.id, []).append(part)
    return tuple(
        PrimitiveCount(number, name(parts[0]), len(parts), sum(part.end - part.start for part in parts))
        for number, parts in sorted(groups.items())
    )


def _tracking(log: FlightLog) -> tuple[TrackingError, ...] | None:
    units = {field.name: field.unit for field in TRUTH.fields}
    time = log[TRUTH].time
    errors = []
    for field in VELOCITIES:
        if not (log[TRUTH].has_fields(field) and log[COMMAND].has_fields(field)):
            continue
        error = tracking_error(log, field)
        if not np.isfinite(error).any():
            continue
        worst = int(np.nanargmax(np.abs(error)))
        errors.append(
            TrackingError(field, units[field], float(error[worst]), float(time[worst]), _rms(error))
        )
    return tuple(errors) or None


def _navigation(log: FlightLog) -> NavigationError:
    position = np.hypot(navigation_error(log, "north"), navigation_error(log, "east"))
    velocity = np.hypot(navigation_error(log, "forward"), navigation_error(log, "side"))
    return NavigationError(
        position_rms=_rms(position),
        position_max=float(np.nanmax(position)),
        velocity_rms=_rms(velocity),
        heading_rms=_rms(navigation_error(log, "heading")),
    )


def _rms(values: Column) -> float:
    return float(np.sqrt(np.nanmean(np.square(values))))
