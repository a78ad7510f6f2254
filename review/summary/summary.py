"""A flight in a few numbers: what was flown, how well it was tracked and believed, where bounds were left."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.mission.goal import Arrival, Destination, first_arrival
from flightlog.attachment_names import PLANS_ATTACHMENT
from flightlog.attachments import PlanOfFlight, goal_of_flight, plannings_of_flight
from flightlog.channels import COMMAND, ESTIMATE, PRIMITIVE, TRUTH
from flightlog.fault_record import faults_flown
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveFlown, PrimitiveKind, stretches_flown
from flightlog.topic import Series
from flightlog.trim_labels import trim_names

from .bound_check import Bounds, bounds_kept
from .tracking import VELOCITIES, navigation_error, tracking_error

Column = Float[np.ndarray, "n"]
Track = Float[np.ndarray, "m 2"]


@dataclass(frozen=True, slots=True)
class PrimitiveCount:
    """How often and how long one primitive was flown: its id, a few words, times flown, seconds in all."""

    id: int
    name: str
    count: int
    seconds: float


@dataclass(frozen=True, slots=True)
class TrackingError:
    """Truth minus command of one velocity.

    Attributes:
        field: `forward`, `side` or `yaw_rate`.
        unit: of the numbers.
        worst: the largest, with its sign.
        time: of the largest, seconds since the flight's start.
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
        position_rms: of the distance between the two positions.
        position_max: the largest distance.
        velocity_rms: of the length of the difference of the two velocities.
        heading_rms: of the difference of the two headings.
    """

    position_rms: float
    position_max: float
    velocity_rms: float
    heading_rms: float


@dataclass(frozen=True, slots=True)
class Summary:
    """What a log says about its flight; what the log does not hold is None, never zero.

    Attributes:
        kind: `sequence`, `campaign` or `mission`.
        name: of the sequence, campaign or mission.
        vehicle: what flew.
        seed: of every random number of the flight.
        wind: wind class.
        duration: seconds.
        distance: length of the track over the ground, metres; the true one, or the believed one without it;
            None where positions are not known.
        outcome: `completed`, or what went wrong.
        trims: coasts flown, by trim.
        maneuvers: maneuvers flown, by id.
        timeouts: maneuvers that ended by time-out.
        tracking: one for each velocity that a trim fixes; None without command or truth.
        navigation: None without estimate or truth.
        bounds: None without library, truth or primitives.
        faults: what went wrong on purpose, when and how far, a sentence each.
        plans: how many plannings found something to fly; None where the log carries no plans.
        failures: how many plannings found nothing, so that the vehicle flew on with what it had.
        promise: seconds that the first plan promised; None without one.
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
    bounds: Bounds | None
    faults: tuple[str, ...]
    plans: int | None
    failures: int
    promise: float | None
    arrival: Arrival | None


def summarise(log: FlightLog) -> Summary:
    """Returns what a log says about its flight.

    Raises:
        FlightError: the log has neither truth nor estimate, or an attachment is broken.
    """
    header = log.header
    flown = stretches_flown(log) if PRIMITIVE.name in log.series else ()
    names = trim_names(log)
    goal = goal_of_flight(log)
    plannings = plannings_of_flight(log)
    plans = [planning for planning in plannings if isinstance(planning, PlanOfFlight)]
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
        bounds=bounds_kept(log) if true and PRIMITIVE.name in log.series else None,
        faults=tuple(f"{flown.start:.2f} s: {flown.sentence}" for flown in faults_flown(log).values()),
        plans=len(plans) if PLANS_ATTACHMENT in log.attachments else None,
        failures=len(plannings) - len(plans),
        promise=plans[0].cost if plans else None,
        arrival=arrival(log, goal) if true and goal is not None else None,
    )


def _distance(motion: Series) -> float | None:
    if not motion.holds("north", "east"):
        return None
    return float(np.hypot(np.diff(motion["north"]), np.diff(motion["east"])).sum())


def _navigates(log: FlightLog) -> bool:
    """Whether both the truth and the estimate are known well enough to be held against one another."""
    needed = ("north", "east", "forward", "side", "heading")
    return all(topic.name in log.series and log[topic].holds(*needed) for topic in (TRUTH, ESTIMATE))


def _trim_label(trim: int, names: dict[int, str]) -> str:
    return names.get(trim, f"trim {trim}")


def _counts(
    flown: tuple[PrimitiveFlown, ...], kind: PrimitiveKind, name: Callable[[PrimitiveFlown], str]
) -> tuple[PrimitiveCount, ...]:
    groups: dict[int, list[PrimitiveFlown]] = {}
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
        if not (log[TRUTH].holds(field) and log[COMMAND].holds(field)):
            continue
        error = tracking_error(log, field)
        worst = int(np.argmax(np.abs(error)))
        errors.append(
            TrackingError(field, units[field], float(error[worst]), float(time[worst]), _rms(error))
        )
    return tuple(errors) or None


def _navigation(log: FlightLog) -> NavigationError:
    position = np.hypot(navigation_error(log, "north"), navigation_error(log, "east"))
    velocity = np.hypot(navigation_error(log, "forward"), navigation_error(log, "side"))
    return NavigationError(
        position_rms=_rms(position),
        position_max=float(position.max()),
        velocity_rms=_rms(velocity),
        heading_rms=_rms(navigation_error(log, "heading")),
    )


def arrival(log: FlightLog, destination: Destination) -> Arrival:
    """Returns how the true track, as a line between its samples, met where it was to go.

    Raises:
        MissingTopicError: the log has no truth.
    """
    truth = log[TRUTH]
    track = np.column_stack([truth.time, *(truth[name] for name in ("north", "east", "heading"))])
    return first_arrival([track], destination)


def _rms(values: Column) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
