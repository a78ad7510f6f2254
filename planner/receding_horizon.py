"""Closed loop: plan, fly a little of it, plan again from where the vehicle believes to be (thesis, 6.3)."""

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from math import inf

from flight.arrival import Arrival, first_arrival
from flight.errors import FlightError, FlightLostError
from flight.library import Library
from flight.mission import Mission
from flight.plan import Plan
from flight.vehicle import Leg, Vehicle

from .policy import Planner

LONGEST_INTERVAL = 3600.0
"""Seconds between two plannings; long enough for a plan to be flown as it is."""

SHORTEST_COAST = 1e-3
"""Seconds; a shorter coast is not flown."""


class NoToleranceError(FlightError):
    """A mission that is to be flown asks for its goal to be met exactly."""

    def __init__(self, mission: str) -> None:
        super().__init__(f"mission {mission}: a flight needs a goal tolerance > 0 m, got 0 m; give one")


@dataclass(frozen=True, slots=True)
class Settings:
    """How the loop is closed.

    Attributes:
        activation_interval: seconds between two plannings; a maneuver under way is finished first.
        max_activations: plannings after which the flight is given up.
        final_tolerance: metres within which the goal counts as reached; None for the mission's.
        tolerance_share: of the distance to go; the planner is handed that as its tolerance where it is larger
            than the final one (thesis, 6.3.1).
    """

    activation_interval: float = 1.0
    max_activations: int = 100
    final_tolerance: float | None = None
    tolerance_share: float = 0.1

    def __post_init__(self) -> None:
        """Refuses a loop that cannot run."""
        if not 0 < self.activation_interval <= LONGEST_INTERVAL:
            raise ValueError(
                f"activation_interval must be > 0 and <= {LONGEST_INTERVAL} s, "
                f"got {self.activation_interval} s"
            )
        if self.max_activations < 1:
            raise ValueError(f"max_activations must be >= 1, got {self.max_activations}")
        if self.final_tolerance is not None and not 0 < self.final_tolerance < inf:
            raise ValueError(f"final_tolerance must be > 0 m, got {self.final_tolerance} m")
        if not 0 <= self.tolerance_share < 1:
            raise ValueError(f"tolerance_share must be in [0, 1), got {self.tolerance_share}")


@dataclass(frozen=True, slots=True, eq=False)
class Flown:
    """What a closed-loop flight came to.

    Attributes:
        reached: whether the true track entered the final tolerance, in the trim wanted there.
        flown_time: seconds to there; the whole flight's where it was not reached.
        predicted_time: seconds that the policy promises from the start to the final tolerance; infinite
            without a plan.
        closest: metres between the goal and the nearest point of the true track.
        activations: how often it was planned.
        failures: how often that gave no plan.
        plans: every plan, in order.
        times: seconds since the start at which each was made.
        missions: what each of them was asked: from where, how exactly.
        legs: what was flown, in order.
        reason: how it ended, one sentence.
    """

    reached: bool
    flown_time: float
    predicted_time: float
    closest: float
    activations: int
    failures: int
    plans: tuple[Plan, ...]
    times: tuple[float, ...]
    missions: tuple[Mission, ...]
    legs: tuple[Leg, ...]
    reason: str


@dataclass(slots=True)
class _Remainder:
    """What is left of the plan that is being flown: coasting times, and the trims that they lead to."""

    coasts: deque[float] = field(default_factory=deque)
    trims: deque[int] = field(default_factory=deque)

    @classmethod
    def of(cls, plan: Plan) -> "_Remainder":
        return cls(deque(plan.coasting_times), deque(plan.sequence[1:]))


@dataclass(slots=True)
class _Record:
    """What has happened so far."""

    promise: Plan
    plans: list[Plan] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    missions: list[Mission] = field(default_factory=list)
    legs: list[Leg] = field(default_factory=list)
    held: list[int | None] = field(default_factory=list)

    def add(self, leg: Leg, held: int | None) -> None:
        """Notes a leg, and the trim that was held in it; None for a maneuver."""
        self.legs.append(leg)
        self.held.append(held)

    def arrival(self, goal: Mission) -> Arrival:
        """Returns when the goal was entered; where a trim is wanted there, while that was held."""
        stretches = zip(self.legs, self.held, strict=True)
        wanted = [leg.track for leg, held in stretches if goal.goal_trim in {None, held}]
        return first_arrival(wanted, goal.destination)

    def flown(self, vehicle: Vehicle, arrival: Arrival, reason: str) -> Flown:
        return Flown(
            reached=arrival.time is not None,
            flown_time=vehicle.time if arrival.time is None else arrival.time,
            predicted_time=self.promise.cost,
            closest=arrival.closest,
            activations=len(self.plans),
            failures=sum(not plan.found for plan in self.plans),
            plans=tuple(self.plans),
            times=tuple(self.times),
            missions=tuple(self.missions),
            legs=tuple(self.legs),
            reason=reason,
        )


def fly(
    vehicle: Vehicle,
    mission: Mission,
    *,
    planner: Planner,
    library: Library,
    settings: Settings | None = None,
) -> Flown:
    """Flies a mission in closed loop, from where the vehicle is, until the goal, the limit or the end.

    A planning that fails is counted, and the rest of the plan before it is flown on; where nothing is left,
    the trim is held. The flight ends as not reached if the first planning fails, if a maneuver times out, if
    the vehicle is lost, or at the limit of plannings.

    Args:
        vehicle: what flies; its pose is what it believes.
        mission: the goal and how exactly; where it starts from, the vehicle knows better.
        planner: the policy.
        library: of the maneuvers that plans name.
        settings: how the loop is closed.

    Raises:
        NoToleranceError: neither the mission nor the settings give a tolerance above 0.
        UnknownTrimError: the library lacks a trim of the mission.
    """
    settings = settings or Settings()
    goal = replace(mission, tolerance=settings.final_tolerance or mission.tolerance)
    if goal.tolerance == 0:
        raise NoToleranceError(mission.name)
    # The promise is for the goal as it is judged; the plans flown first are for a wider one.
    promise = planner.plan(replace(goal, start=vehicle.pose, start_trim=vehicle.trim))
    record, left = _Record(promise), _Remainder()
    reason = f"{settings.max_activations} plannings did not lead to the goal"
    for activation in range(settings.max_activations):
        asked = _from_here(vehicle, goal, settings.tolerance_share)
        plan = planner.plan(asked)
        record.plans.append(plan)
        record.times.append(vehicle.time)
        record.missions.append(asked)
        if plan.found:
            left = _Remainder.of(plan)
        elif activation == 0:
            reason = f"no plan from the start: {plan.reason}"
            break
        stopped = _advance(vehicle, left, library, settings.activation_interval, record)
        if record.arrival(goal).time is not None:
            reason = "reached the goal"
            break
        if stopped:
            reason = stopped
            break
    return record.flown(vehicle, record.arrival(goal), reason)


def _from_here(vehicle: Vehicle, goal: Mission, share: float) -> Mission:
    distance = vehicle.pose.distance_to(goal.goal)
    return replace(
        goal,
        start=vehicle.pose,
        start_trim=vehicle.trim,
        tolerance=max(goal.tolerance, share * distance),
    )


def _advance(vehicle: Vehicle, left: _Remainder, library: Library, interval: float, record: _Record) -> str:
    """Flies the plan for an interval, and a maneuver begun in it to its end.

    Returns:
        Why the flight cannot go on; empty where it can.
    """
    until = vehicle.time + interval
    try:
        for leg, held in _legs(vehicle, left, library, until):
            record.add(leg, held)
            if not leg.settled:
                return f"a maneuver to trim {vehicle.trim} timed out after {leg.duration:.1f} s"
    except FlightLostError as error:
        return str(error)
    return ""


def _legs(
    vehicle: Vehicle, left: _Remainder, library: Library, until: float
) -> Iterable[tuple[Leg, int | None]]:
    while (time := until - vehicle.time) > SHORTEST_COAST:
        due = left.coasts[0] if left.coasts else 0.0
        if not left.trims:
            # The plan is flown: it promised no more than to be near, so the trim is held.
            yield vehicle.coast(time), vehicle.trim
            return
        if due > time:
            left.coasts[0] = due - time
            yield vehicle.coast(time), vehicle.trim
            return
        if due > SHORTEST_COAST:
            yield vehicle.coast(due), vehicle.trim
        left.coasts.popleft()
        yield vehicle.perform(library.maneuver(vehicle.trim, left.trims.popleft())), None
