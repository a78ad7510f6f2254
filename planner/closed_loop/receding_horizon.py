"""Receding horizon: plan, fly one interval, replan from the estimate (thesis, 6.3)."""

from collections.abc import Callable
from dataclasses import replace
from math import inf

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg, Vehicle
from flight.errors import FlightError, FlightLostError
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from flight.se2 import SE2
from flightlog.decision import DecisionKind
from planner.policies.policy import Planner
from planner.walks.safe_stop import safe_stop_path

from .acceptance import Acceptance, judge_plan
from .flight_record import FlightRecord, FlightRecorder
from .gamma_estimator import GammaEstimator
from .remaining_plan import SHORTEST_COAST, PlanStep, RemainingPlan
from .settings import Settings


class NoToleranceError(FlightError):
    """A mission to be flown has no goal tolerance."""

    def __init__(self, mission: str) -> None:
        super().__init__(f"mission {mission}: expected a goal tolerance > 0 m for a flight, got 0 m")


def fly_closed_loop(
    vehicle: Vehicle,
    mission: Mission,
    *,
    planner: Planner,
    library: Library,
    settings: Settings | None = None,
    on_leg: Callable[[Leg], None] | None = None,
) -> FlightRecord:
    """Flies a mission in closed loop until arrival, loss or limit.

    After a plan that is missing, late or refused, the previous plan is flown on, and then its safe-stop path,
    which cannot reach the goal. The flight ends as not reached if the first planning fails, a maneuver times
    out, the vehicle is lost or raises an alarm, or at the limit of replans. It ends where the vehicle
    declares arrival; the true track decides whether the goal was reached.

    Args:
        vehicle: the vehicle; its pose is an estimate.
        mission: goal and tolerance; its start is replaced by the vehicle's pose.
        planner: the policy; its plans are checked.
        library: of the maneuvers that plans name.
        settings: of the closed loop.
        on_leg: called with every flown leg, such as by a planner that adapts.

    Raises:
        NoToleranceError: neither the mission nor the settings give a tolerance above 0.
        UnknownTrimError: the library lacks a trim of the mission.
    """
    settings = settings or Settings()
    goal = replace(mission, tolerance=settings.final_tolerance or mission.tolerance)
    if goal.tolerance == 0:
        raise NoToleranceError(mission.name)
    return _Loop(vehicle, goal, planner, library, settings, on_leg=on_leg).fly_closed_loop()


class _Loop:
    def __init__(
        self,
        vehicle: Vehicle,
        goal: Mission,
        planner: Planner,
        library: Library,
        settings: Settings,
        *,
        on_leg: Callable[[Leg], None] | None,
    ) -> None:
        self._vehicle, self._goal, self._planner = vehicle, goal, planner
        self._library, self._settings, self._on_leg = library, settings, on_leg
        self._record = FlightRecorder(goal, settings.arrival_probability)
        self._left = RemainingPlan(vehicle.trim, tail=safe_stop_path(library, vehicle.trim))
        self._levels = GammaEstimator(library, goal.goal)
        self._level = 0.0
        self._lost = False

    def fly_closed_loop(self) -> FlightRecord:
        # The predicted time is for the final tolerance; plans flown earlier may aim at a wider one.
        latency = self._settings.latency.configured
        steps, _ = self._left.window(latency)
        bound = self._planner.plan(self._mission_ahead(steps, share=0.0))
        self._record.predicted_time = latency + bound.cost
        reason = f"{self._settings.max_activations} replans did not reach the goal"
        for _ in range(self._settings.max_activations):
            ended = self._replan()
            if self._record.claimed:
                reason = "reached the goal"
                break
            if ended:
                reason = ended
                break
        if not self._record.claimed and not self._lost and self._record.legs:
            self._stop_safely()
        return self._record.close(self._vehicle.time, reason)

    def _replan(self) -> str:
        """Plans once and flies until the next replan.

        Returns:
            The reason for the end of the flight; empty if it continues.
        """
        began = self._vehicle.time
        steps, rest = self._left.window(self._fly_while_planning())
        asked, plan = self._plan_mission(
            self._mission_ahead(steps, share=self._settings.tolerance_share), rest
        )
        latency = self._settings.latency.of(len(self._record.plans), plan)
        first = not self._record.plans
        self._record.add_planning(began, asked, plan, latency)
        verdict = self._judge(plan, asked, late=latency > self._settings.latency.configured)
        if first and verdict.kind is not DecisionKind.ADOPTED:
            self._record.decide(began, verdict.kind, cost=inf, level=self._level)
            return f"no plan from the start: {verdict.reason}"
        if ended := self._fly(steps):
            return ended
        self._choose(verdict, asked, plan, rest)
        return self._advance(began + self._settings.activation_interval)

    def _fly_while_planning(self) -> float:
        """Returns the flight time before the plan; due maneuvers are flown first."""
        due = self._settings.replan_in_maneuver and self._left.maneuver_due
        return inf if due else self._settings.latency.configured

    def _mission_ahead(self, steps: tuple[PlanStep, ...], *, share: float) -> Mission:
        """Returns the mission from the pose predicted at plan delivery."""
        pose, trim = self._vehicle.pose, self._vehicle.trim
        for step in steps:
            pose = step.exit(pose, self._library, self._level)
            trim = step.trim if step.to_trim is None else step.to_trim
        distance = pose.distance_to(self._goal.goal)
        tolerance = max(self._settings.aim * self._goal.tolerance, share * distance)
        return replace(self._goal, start=pose, start_trim=trim, tolerance=tolerance)

    def _plan_mission(self, asked: Mission, rest: RemainingPlan) -> tuple[Mission, Plan]:
        """Returns mission and plan, with a tightened tolerance where that is cheap.

        If the current plan no longer leads to the goal and a plan for the full tolerance is clearly faster,
        that one is taken: the automaton has no small corrections.
        """
        plan, goal = self._planner.plan(asked), self._goal.tolerance
        if asked.tolerance >= goal or self._arrival_time(rest, asked.start) < inf:
            return asked, plan
        close = replace(asked, tolerance=goal)
        faster = self._planner.plan(close)
        took = plan.solve_time + faster.solve_time
        acceptable = self._judge(faster, close).kind is DecisionKind.ADOPTED
        if acceptable and faster.cost + self._settings.hysteresis < plan.cost:
            return close, replace(faster, solve_time=took)
        return asked, replace(plan, solve_time=took)

    def _judge(self, plan: Plan, asked: Mission, *, late: bool = False) -> Acceptance:
        return judge_plan(plan, self._library, asked, late=late)

    def _choose(self, verdict: Acceptance, asked: Mission, plan: Plan, rest: RemainingPlan) -> None:
        """Adopts the new plan, keeps the current one, or stops safely."""
        now, self._left = self._vehicle.time, rest
        if verdict.kind is not DecisionKind.ADOPTED:
            self._record.decide(now, verdict.kind, cost=inf, level=self._level)
            return
        scenario = self._scenario(plan)
        remaining = self._arrival_time(rest, asked.start)
        # The same walk with other coasting times is an update of the current plan.
        same = (rest.trim, *rest.trims) == plan.sequence
        if self._settings.hysteresis and not same and remaining <= scenario.cost + self._settings.hysteresis:
            self._record.decide(now, DecisionKind.KEPT, cost=remaining, level=self._level)
            return
        self._level = scenario.gamma
        self._left = RemainingPlan.of(plan, scenario)
        self._record.decide(now, DecisionKind.ADOPTED, cost=plan.cost, level=scenario.gamma)

    def _scenario(self, plan: Plan) -> Scenario:
        """Returns the scenario whose coasting times are flown."""
        if not self._settings.learn_level:
            return plan.deciding
        gammas = [scenario.gamma for scenario in plan.scenarios]
        shown = self._levels.estimate(gammas, otherwise=plan.deciding.gamma)
        return next((one for one in plan.scenarios if one.gamma == shown), plan.deciding)

    def _arrival_time(self, rest: RemainingPlan, start: SE2) -> float:
        """Returns the predicted time to the goal; infinite for a predicted miss.

        The wanted heading and trim at the goal are not checked.
        """
        goal = self._goal
        if rest.finished or rest.is_safe_stop or (goal.goal_heading, goal.goal_trim) != (None, None):
            return inf
        end, time = rest.predicted_end(start, self._library, self._level)
        return time if goal.destination.reached(end) else inf

    def _advance(self, until: float) -> str:
        """Flies the remaining plan for a time, finishing any begun maneuver."""
        while (time := until - self._vehicle.time) > SHORTEST_COAST:
            if self._left.finished and self._record.refused and not self._left.is_safe_stop:
                self._begin_safe_stop()
            if self._left.maneuver_due and self._settings.replan_in_maneuver and not self._left.is_safe_stop:
                return ""
            step, self._left = self._left.step(time)
            if ended := self._fly((step,)):
                return ended
        return ""

    def _begin_safe_stop(self) -> None:
        self._left = self._left.safe_stop()
        self._record.decide(self._vehicle.time, DecisionKind.FALLBACK, cost=inf, level=self._level)

    def _stop_safely(self) -> None:
        """Flies the safe-stop path after a failed mission."""
        self._left = RemainingPlan(self._vehicle.trim, tail=safe_stop_path(self._library, self._vehicle.trim))
        self._begin_safe_stop()
        while self._left.trims:
            step, self._left = self._left.step(0.0)
            if self._fly((step,)) and self._record.decisions[-1].kind is not DecisionKind.ALARM:
                return
        if self._settings.wait:
            self._fly((PlanStep(self._vehicle.trim, self._settings.wait),))

    def _fly(self, steps: tuple[PlanStep, ...]) -> str:
        """Flies steps, records them and updates the gamma estimate.

        Returns:
            The reason for the end of the flight; empty if it continues.
        """
        vehicle = self._vehicle
        for step in steps:
            begin = vehicle.pose
            try:
                if step.to_trim is None:
                    leg = vehicle.coast(step.duration)
                else:
                    leg = vehicle.perform(self._library.maneuver(step.trim, step.to_trim))
            except FlightLostError as error:
                self._lost = True
                self._record.add_lost_leg(step, error)
                return str(error)
            on_a_plan = not self._record.refused or not self._record.plans
            self._record.add_leg(step, leg, on_a_plan=on_a_plan and not self._left.is_safe_stop)
            if leg.alarm:
                self._record.decide(vehicle.time, DecisionKind.ALARM, cost=inf, level=self._level)
                return f"alarm: {leg.alarm}"
            if not leg.settled:
                return f"a maneuver to trim {vehicle.trim} timed out after {leg.duration:.1f} s"
            if self._record.decisions:
                self._levels.update(step, begin, vehicle.pose)
            if self._on_leg is not None:
                self._on_leg(leg)
        return ""
