"""Closed loop: plan, fly a little of it, plan again from where the vehicle believes to be (thesis, 6.3)."""

from dataclasses import dataclass, field, replace
from math import inf

from flight.decision import DecisionKind
from flight.errors import FlightError, FlightLostError
from flight.library import Library
from flight.library_file import library_hash
from flight.mission import Mission
from flight.plan import Plan, Scenario
from flight.se2 import SE2
from flight.vehicle import Vehicle

from .flown import FlightRecord, Flown
from .latency import Latency
from .levels import Levels
from .policy import Planner
from .remainder import SHORTEST_COAST, Remainder, Step
from .tail import way_to_rest
from .verdict import Verdict, judge

LONGEST_INTERVAL = 3600.0
"""Seconds between two plannings; long enough for a plan to be flown as it is."""


class NoToleranceError(FlightError):
    """A mission that is to be flown asks for its goal to be met exactly."""

    def __init__(self, mission: str) -> None:
        super().__init__(f"mission {mission}: a flight needs a goal tolerance > 0 m, got 0 m; give one")


@dataclass(frozen=True, slots=True)
class Settings:
    """How the loop is closed.

    Attributes:
        activation_interval: seconds between two plannings; a maneuver under way is finished first.
        max_activations: plannings after which the flight is given up, and the vehicle brought to rest.
        final_tolerance: metres within which the goal counts as reached; None for the mission's.
        tolerance_share: of the distance to go; the planner is handed that as its tolerance where it is larger
            than the final one (thesis, 6.3.1).
        aim: part of the final tolerance that the planner is handed: a plan of least time ends at the edge of
            what it is given, where every error misses.
        latency: for how long the vehicle flies on while a plan is made.
        replan_in_maneuver: whether it is planned again during every maneuver, from where it is foretold to
            end, so that the plan is ready there (thesis, 6.3.3).
        hysteresis: seconds by which a new plan must be faster than the one under way, where that still leads
            to the goal, to be taken instead.
        learn_level: whether the coasting times flown are those of the uncertainty level that the vehicle has
            shown so far, not those of the deciding one.
    """

    activation_interval: float = 0.5
    max_activations: int = 200
    final_tolerance: float | None = None
    tolerance_share: float = 0.0
    aim: float = 0.5
    latency: Latency = field(default_factory=Latency)
    replan_in_maneuver: bool = False
    hysteresis: float = 1.0
    learn_level: bool = True

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
        if not 0 < self.aim <= 1:
            raise ValueError(f"aim must be in (0, 1], got {self.aim}")
        if not 0 <= self.hysteresis < inf:
            raise ValueError(f"hysteresis must be >= 0 s, got {self.hysteresis} s")


def fly(
    vehicle: Vehicle,
    mission: Mission,
    *,
    planner: Planner,
    library: Library,
    settings: Settings | None = None,
) -> Flown:
    """Flies a mission in closed loop, from where the vehicle is, until the goal, the limit or the end.

    A planning that fails, is late or fails its check is noted, and the plan before it is flown on; where that
    is used up, its way to rest is flown. Nothing that is flown so can reach the goal: that takes a plan. The
    flight ends as not reached if the first planning fails, if a maneuver times out, if the vehicle is lost,
    or at the limit of plannings.

    Args:
        vehicle: what flies; its pose is what it believes.
        mission: the goal and how exactly; where it starts from, the vehicle knows better.
        planner: the policy; what it answers is checked.
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
    return _Loop(vehicle, goal, planner, library, settings).fly()


class _Loop:
    def __init__(
        self, vehicle: Vehicle, goal: Mission, planner: Planner, library: Library, settings: Settings
    ) -> None:
        self._vehicle, self._goal, self._planner = vehicle, goal, planner
        self._library, self._settings = library, settings
        self._hash = library_hash(library)
        self._record = FlightRecord(goal)
        self._left = Remainder(vehicle.trim, tail=way_to_rest(library, vehicle.trim))
        self._levels: Levels | None = None
        self._level = 0.0
        self._lost = False

    def fly(self) -> Flown:
        # The promise is for the goal as it is judged; the plans flown first are for a wider one.
        thinking = self._settings.latency.configured
        steps, _ = self._left.window(thinking)
        promise = self._planner.plan(self._asked(steps, share=0.0))
        self._record.predicted_time = thinking + promise.cost
        reason = f"{self._settings.max_activations} plannings did not lead to the goal"
        for _ in range(self._settings.max_activations):
            ended = self._activate()
            if self._record.arrived:
                reason = "reached the goal"
                break
            if ended:
                reason = ended
                break
        if not self._record.arrived and not self._lost and self._record.legs:
            self._come_to_rest()
        return self._record.close(self._vehicle.time, reason)

    def _activate(self) -> str:
        """Plans once, and flies until it is time to plan again.

        Returns:
            Why the flight cannot go on; empty where it can.
        """
        began = self._vehicle.time
        steps, rest = self._left.window(self._thinking())
        asked = self._asked(steps, share=self._settings.tolerance_share)
        plan = self._planner.plan(asked)
        latency = self._settings.latency.of(len(self._record.plans), plan)
        first = not self._record.plans
        self._record.add_planning(began, asked, plan, latency)
        late = latency > self._settings.latency.configured
        verdict = judge(plan, self._library, asked, known_hash=self._hash, late=late)
        if first and verdict.kind is not DecisionKind.ADOPTED:
            self._record.decide(began, verdict.kind, cost=inf, level=self._level)
            return f"no plan from the start: {verdict.reason}"
        ended = self._fly(steps) or self._choose(verdict, asked, plan, rest)
        return ended or self._advance(began + self._settings.activation_interval)

    def _thinking(self) -> float:
        """Returns for how long the vehicle flies on before the plan is; a maneuver that is due is flown."""
        due = self._settings.replan_in_maneuver and self._left.maneuver_due
        return inf if due else self._settings.latency.configured

    def _asked(self, steps: tuple[Step, ...], *, share: float) -> Mission:
        """Returns the mission from where the vehicle will be when the plan is there."""
        pose, trim = self._vehicle.pose, self._vehicle.trim
        for step in steps:
            pose = step.exit(pose, self._library, self._level)
            trim = step.trim if step.to_trim is None else step.to_trim
        distance = pose.distance_to(self._goal.goal)
        tolerance = max(self._settings.aim * self._goal.tolerance, share * distance)
        return replace(self._goal, start=pose, start_trim=trim, tolerance=tolerance)

    def _choose(self, verdict: Verdict, asked: Mission, plan: Plan, rest: Remainder) -> str:
        """Takes the new plan, keeps the one under way, or falls back."""
        now, self._left = self._vehicle.time, rest
        if verdict.kind is not DecisionKind.ADOPTED:
            self._record.decide(now, verdict.kind, cost=inf, level=self._level)
            return ""
        scenario = self._scenario(plan)
        if self._keeps(asked.start, scenario):
            cost = rest.outcome(asked.start, self._library, self._level)[1]
            self._record.decide(now, DecisionKind.KEPT, cost=cost, level=self._level)
            return ""
        self._level = scenario.gamma
        self._left = Remainder.of(plan, scenario)
        self._record.decide(now, DecisionKind.ADOPTED, cost=plan.cost, level=scenario.gamma)
        return ""

    def _scenario(self, plan: Plan) -> Scenario:
        """Returns the scenario whose coasting times are flown."""
        if self._levels is None:
            gammas = [scenario.gamma for scenario in plan.scenarios]
            self._levels = Levels(self._library, gammas, self._goal.goal)
        if not self._settings.learn_level:
            return plan.deciding
        shown = self._levels.shown(otherwise=plan.deciding.gamma)
        return next((one for one in plan.scenarios if one.gamma == shown), plan.deciding)

    def _keeps(self, start: SE2, scenario: Scenario) -> bool:
        """Whether the plan under way still leads to the goal, and not much later than the new one."""
        if not self._settings.hysteresis or self._left.used_up or self._left.fallback or self._record.refused:
            return False
        end, time = self._left.outcome(start, self._library, self._level)
        meets = end.distance_to(self._goal.goal) <= self._goal.tolerance
        wanted = self._goal.goal_heading is None and self._goal.goal_trim is None
        return meets and wanted and time <= scenario.cost + self._settings.hysteresis

    def _advance(self, until: float) -> str:
        """Flies what is left for so long, and a maneuver begun in it to its end."""
        while (time := until - self._vehicle.time) > SHORTEST_COAST:
            if self._left.used_up and self._record.refused and not self._left.fallback:
                self._retreat()
            if self._left.maneuver_due and self._settings.replan_in_maneuver and not self._left.fallback:
                return ""
            step, self._left = self._left.step(time)
            if ended := self._fly((step,)):
                return ended
        return ""

    def _retreat(self) -> None:
        self._left = self._left.retreat()
        self._record.decide(self._vehicle.time, DecisionKind.FALLBACK, cost=inf, level=self._level)

    def _come_to_rest(self) -> None:
        """Gives up: leaves the vehicle where it can stay, not on its way to nowhere."""
        self._left = Remainder(self._vehicle.trim, tail=way_to_rest(self._library, self._vehicle.trim))
        self._retreat()
        while self._left.trims:
            step, self._left = self._left.step(0.0)
            if self._fly((step,)):
                return

    def _fly(self, steps: tuple[Step, ...]) -> str:
        """Flies steps, notes them, and learns from them.

        Returns:
            Why the flight cannot go on; empty where it can.
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
                self._record.add_lost(step, error)
                return str(error)
            on_a_plan = not self._record.refused or not self._record.plans
            self._record.add_leg(step, leg, on_a_plan=on_a_plan and not self._left.fallback)
            if not leg.settled:
                return f"a maneuver to trim {vehicle.trim} timed out after {leg.duration:.1f} s"
            if self._levels is not None:
                self._levels.see(step, begin, vehicle.pose)
        return ""
