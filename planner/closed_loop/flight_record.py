"""Record of a closed-loop flight."""

from dataclasses import dataclass, field, replace
from math import inf

from flight.automaton.maneuver import Maneuver
from flight.automaton.vehicle import Leg
from flight.errors import FlightLostError
from flight.mission.arrival import ArrivalVerdict, TrackSegment, claims_arrival, judge_arrival
from flight.mission.destination import first_arrival
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flightlog.decision import Decision, DecisionKind
from planner.recourse.policy import Choice

from .remaining_plan import PlanStep

REFUSALS = (DecisionKind.FAILED, DecisionKind.LATE, DecisionKind.REFUSED)
"""Decisions after which the previous plan is flown on."""


@dataclass(frozen=True, slots=True, eq=False)
class FlightRecord:
    """Result of a closed-loop flight.

    Attributes:
        arrival: judgement of the true track.
        flown_time: seconds to there; the whole flight's where it was not reached.
        predicted_time: seconds that the policy predicts from the start to the part of the tolerance that
            plans aim at, planning included; infinite without a plan.
        replans: number of replans, and of decisions of a policy with feedback.
        failures: replans without an acceptable plan: none found, late, or refused by the check.
        safe_stops: number of safe stops begun.
        plans: every plan of the planner, in order.
        times: seconds since the start at which each planning began.
        latencies: seconds charged for each.
        missions: mission of each planning: start and tolerance.
        decisions: decisions in the order of time.
        legs: flown legs, in order.
        steps: the intended primitive of each leg.
        reason: reason for the end, one sentence.
    """

    arrival: ArrivalVerdict
    flown_time: float
    predicted_time: float
    replans: int
    failures: int
    safe_stops: int
    plans: tuple[Plan, ...]
    times: tuple[float, ...]
    latencies: tuple[float, ...]
    missions: tuple[Mission, ...]
    decisions: tuple[Decision, ...]
    legs: tuple[Leg, ...]
    steps: tuple[PlanStep, ...]
    reason: str

    @property
    def reached(self) -> bool:
        """True where the goal was reached."""
        return self.arrival.reached

    @property
    def claimed(self) -> bool:
        """True where the vehicle declared its arrival."""
        return self.arrival.declared

    @property
    def closest(self) -> float:
        """Least true distance to the goal in metres; infinite without flight."""
        return inf if self.arrival.closest is None else self.arrival.closest


@dataclass(slots=True)
class FlightRecorder:
    """Records a closed-loop flight while it runs.

    Attributes:
        goal: as it is judged.
        arrival_probability: of being inside the goal, at which arrival is declared.
        predicted_time: seconds predicted at the start.
        declared_within: metres from the goal within which arrival is declared, where fewer than the above.
        choices: number of decisions of a policy with feedback.
        claimed: True if the vehicle declared arrival, on a plan and in the trim wanted at the goal.
    """

    goal: Mission
    arrival_probability: float = 0.0
    predicted_time: float = inf
    declared_within: float = inf
    choices: int = 0
    plans: list[Plan] = field(default_factory=list)
    times: list[float] = field(default_factory=list)
    latencies: list[float] = field(default_factory=list)
    missions: list[Mission] = field(default_factory=list)
    decisions: list[Decision] = field(default_factory=list)
    legs: list[Leg] = field(default_factory=list)
    steps: list[PlanStep] = field(default_factory=list)
    on_plan: list[bool] = field(default_factory=list)
    claimed: bool = False

    def add_planning(self, time: float, asked: Mission, plan: Plan, latency: float) -> None:
        """Records a planning request and its plan."""
        self.times.append(time)
        self.missions.append(asked)
        self.plans.append(plan)
        self.latencies.append(latency)

    def add_leg(self, step: PlanStep, leg: Leg, *, on_a_plan: bool) -> None:
        """Records a leg; arrival counts on a plan in the wanted trim."""
        held = step.trim if step.to_trim is None else None
        self.steps.append(step)
        self.legs.append(leg)
        self.on_plan.append(on_a_plan)
        counts = on_a_plan and self.goal.goal_trim in {None, held}
        if counts and not self.claimed and not leg.alarm and self._estimates_arrival(leg):
            self.claimed = True
            self.decide(float(leg.track[-1, 0]), DecisionKind.ARRIVED, cost=0.0, level=self._level)

    def _estimates_arrival(self, leg: Leg) -> bool:
        estimated = leg.track if leg.estimated_track is None else leg.estimated_track
        declared = replace(self.goal.destination, tolerance=min(self.goal.tolerance, self.declared_within))
        return first_arrival([estimated], declared).time is not None and claims_arrival(
            estimated,
            self.goal.destination,
            position_sigma=leg.standard_deviation,
            heading_sigma=leg.heading_deviation,
            probability=self.arrival_probability,
        )

    @property
    def _level(self) -> float:
        return self.decisions[-1].level if self.decisions else 0.0

    def decide(self, time: float, kind: DecisionKind, *, cost: float, level: float) -> None:
        """Records a decision about the latest plan."""
        tolerance = self.missions[-1].tolerance if self.missions else self.goal.tolerance
        latency = self.latencies[-1] if self.latencies else 0.0
        self.decisions.append(Decision(time, kind, len(self.plans), cost, latency, tolerance, level))

    def choose(self, time: float, choice: Choice, *, latency: float, changes: bool) -> None:
        """Records a decision of a policy with feedback."""
        self.choices += 1
        kind = DecisionKind.ADOPTED if changes else DecisionKind.KEPT
        self.decisions.append(
            Decision(
                *(time, kind, self.choices, choice.value, latency, self.declared_within, 0.0),
                choice=_number(choice.maneuver),
                runner_up=_number(choice.runner_up),
                runner_up_cost=choice.runner_up_value,
            )
        )

    @property
    def refused(self) -> bool:
        """Returns True if the latest planning gave no acceptable plan."""
        last = [one.kind for one in self.decisions if one.kind is not DecisionKind.FALLBACK]
        return bool(last) and last[-1] in REFUSALS

    def add_lost_leg(self, step: PlanStep, error: FlightLostError) -> None:
        """Records the leg of the loss; it cannot reach the goal."""
        if error.track is not None:
            duration = float(error.track[-1, 0] - error.track[0, 0])
            self.steps.append(step)
            self.legs.append(Leg(duration, settled=False, track=error.track))
            self.on_plan.append(False)

    def _arrival(self) -> ArrivalVerdict:
        """Returns the arrival verdict of the true track."""
        segments = [
            TrackSegment(leg.track, step.trim if step.to_trim is None else None, on_plan)
            for leg, step, on_plan in zip(self.legs, self.steps, self.on_plan, strict=True)
        ]
        goal = self.goal
        return judge_arrival(segments, goal.destination, trim=goal.goal_trim, declared=self.claimed)

    def close(self, time: float, reason: str) -> FlightRecord:
        """Returns the flight record.

        Args:
            time: seconds since the start at which it ended.
            reason: how, one sentence.
        """
        arrival = self._arrival()
        if arrival.declared and not arrival.reached:
            reason = arrival.reason
        kinds = [one.kind for one in self.decisions]
        return FlightRecord(
            arrival=arrival,
            flown_time=time if arrival.time is None else arrival.time,
            predicted_time=self.predicted_time,
            replans=len(self.plans) + self.choices,
            failures=sum(kind in REFUSALS for kind in kinds),
            safe_stops=kinds.count(DecisionKind.FALLBACK),
            plans=tuple(self.plans),
            times=tuple(self.times),
            latencies=tuple(self.latencies),
            missions=tuple(self.missions),
            decisions=tuple(self.decisions),
            legs=tuple(self.legs),
            steps=tuple(self.steps),
            reason=reason,
        )


def _number(maneuver: Maneuver | None) -> int:
    return 0 if maneuver is None else maneuver.id
