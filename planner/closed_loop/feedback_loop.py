"""Flight of a mission by the policy with feedback."""

from collections.abc import Callable
from math import inf

import numpy as np

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg, Vehicle
from flight.mission.mission import Mission
from flight.plan.policy_statement import PolicyStatement
from flight.se2 import SE2
from flightlog.decision import DecisionKind
from planner.policies.policy import Planner
from planner.recourse.policy import DECISION_INTERVAL, Choice, FeedbackPolicy
from planner.walks.safe_stop import safe_stop_path

from .flight_record import FlightRecord, FlightRecorder
from .primitive_flyer import PrimitiveFlyer
from .receding_horizon import continue_closed_loop
from .remaining_plan import SHORTEST_COAST, PlanStep
from .settings import Settings

# Seconds at the end of a leg over which its velocity is averaged.
_VELOCITY_WINDOW = 0.5


def fly_with_feedback(
    vehicle: Vehicle,
    mission: Mission,
    *,
    policy: FeedbackPolicy,
    statement: PolicyStatement,
    otherwise: Planner,
    settings: Settings | None = None,
    on_leg: Callable[[Leg], None] | None = None,
) -> FlightRecord:
    """Flies a mission by the decisions of a policy with feedback.

    It decides at every maneuver's end and twice a second in coasts.
    A flight that takes longer than 99.9 % of those stated is overdue: from there nominal plans are flown. It
    ends as the receding horizon's flights do, by a safe stop where it has not arrived.

    Args:
        vehicle: the vehicle; its pose is an estimate.
        mission: goal and tolerance, in which the flight is judged.
        policy: made for the goal.
        statement: of the policy about the mission.
        otherwise: planner of an overdue flight.
        settings: latency, arrival probability, number of decisions and wait of the closed loop.
        on_leg: called with every flown leg.
    """
    loop = _FeedbackLoop(vehicle, mission, policy, settings or Settings(), on_leg)
    return loop.fly(statement, otherwise, on_leg)


class _FeedbackLoop:
    def __init__(
        self,
        vehicle: Vehicle,
        goal: Mission,
        policy: FeedbackPolicy,
        settings: Settings,
        on_leg: Callable[[Leg], None] | None,
    ) -> None:
        self._vehicle, self._goal, self._policy, self._settings = vehicle, goal, policy, settings
        self._library: Library = policy.library
        self._record = FlightRecorder(
            goal, settings.arrival_probability, declared_within=policy.table.problem.tolerance
        )
        self._flyer = PrimitiveFlyer(vehicle, self._library, self._record, on_leg)
        self._coasted, self._previous = 0.0, -1
        self._offset = (0.0, 0.0, 0.0)

    def fly(
        self, statement: PolicyStatement, otherwise: Planner, on_leg: Callable[[Leg], None] | None
    ) -> FlightRecord:
        self._record.predicted_time = inf if statement.mean is None else statement.mean
        most = statement.patience.time if statement.within_999 is None else statement.within_999
        reason = f"{self._settings.max_activations} decisions did not reach the goal"
        while self._record.choices < self._settings.max_activations:
            if self._vehicle.time > most:
                self._record.decide(self._vehicle.time, DecisionKind.OVERDUE, cost=inf, level=0.0)
                return self._continue(otherwise, on_leg)
            ended = self._decide_and_fly()
            if self._record.claimed:
                reason = "reached the goal"
                break
            if ended:
                reason = ended
                break
        if not self._record.claimed and not self._flyer.lost:
            self._stop_safely()
        return self._record.close(self._vehicle.time, reason)

    def _decide_and_fly(self) -> str:
        """Decides for the pose after the latency, and flies the action."""
        latency = self._settings.latency.configured
        choice = self._choice_after(latency)
        perform = choice.maneuver is not None
        self._record.choose(self._vehicle.time, choice, latency=latency, changes=perform)
        time = latency if perform else max(DECISION_INTERVAL, latency)
        if time > SHORTEST_COAST and (ended := self._coast(time)):
            return ended
        if choice.maneuver is None or self._record.claimed:
            return ""
        self._coasted, self._previous = 0.0, choice.maneuver.id
        return self._step(PlanStep(choice.maneuver.from_trim, 0.0, choice.maneuver.to_trim))

    def _choice_after(self, latency: float) -> Choice:
        trim = self._vehicle.trim
        pose = self._vehicle.pose @ SE2.exp(self._policy.mean_velocity(trim), latency)
        return self._policy.decide(
            pose,
            trim,
            self._goal.goal,
            coasted=self._coasted + latency,
            previous=None if self._previous < 0 else self._previous,
            offset=self._offset,
        )

    def _coast(self, time: float) -> str:
        self._coasted += time
        return self._step(PlanStep(self._vehicle.trim, time))

    def _step(self, step: PlanStep, *, on_a_plan: bool = True) -> str:
        ended = self._flyer.fly(step, on_a_plan=on_a_plan)
        if not ended:
            self._offset = self._believed_offset()
        return ended

    def _believed_offset(self) -> tuple[float, float, float]:
        """Returns the estimated velocity less the trim's command."""
        leg = self._record.legs[-1]
        track = leg.track if leg.estimated_track is None else leg.estimated_track
        begin = track[np.searchsorted(track[:, 0], track[-1, 0] - _VELOCITY_WINDOW)]
        time = float(track[-1, 0] - begin[0])
        if time <= 0:
            return 0.0, 0.0, 0.0
        moved = SE2(*begin[1:].tolist()).inverse() @ SE2(*track[-1, 1:].tolist())
        command = self._library.trim(self._vehicle.trim).velocity
        # The chord of an arc lies half the turn to the side of the velocity at its end.
        turned = SE2(0.0, 0.0, -0.5 * moved.heading) @ SE2(moved.x, moved.y, 0.0)
        return (
            turned.x / time - command.forward,
            turned.y / time - command.side,
            moved.heading / time - command.yaw_rate,
        )

    def _stop_safely(self) -> None:
        """Flies the safe-stop path after a failed mission."""
        self._record.decide(self._vehicle.time, DecisionKind.FALLBACK, cost=inf, level=0.0)
        for trim in safe_stop_path(self._library, self._vehicle.trim):
            step = PlanStep(self._vehicle.trim, 0.0, trim)
            if (
                self._step(step, on_a_plan=False)
                and self._record.decisions[-1].kind is not DecisionKind.ALARM
            ):
                return
        if self._settings.wait:
            self._step(PlanStep(self._vehicle.trim, self._settings.wait), on_a_plan=False)

    def _continue(self, planner: Planner, on_leg: Callable[[Leg], None] | None) -> FlightRecord:
        """Flies an overdue mission on by plans."""
        return continue_closed_loop(
            self._vehicle,
            self._goal,
            planner=planner,
            library=self._library,
            settings=self._settings,
            record=self._record,
            on_leg=on_leg,
        )
