"""The unflown part of a plan and its predicted end."""

from dataclasses import dataclass, replace

from flight.automaton.library import Library
from flight.plan.plan import Plan, Scenario
from flight.se2 import SE2
from planner.walks.walk import Walk

SHORTEST_COAST = 1e-3
"""Seconds; a shorter coast is not flown."""


@dataclass(frozen=True, slots=True)
class PlanStep:
    """One primitive to fly: a coast or a maneuver.

    Attributes:
        trim: id of the trim held at its begin.
        duration: seconds of a coast; 0 for a maneuver.
        to_trim: id of the trim that a maneuver leads to; None for a coast.
    """

    trim: int
    duration: float
    to_trim: int | None = None

    def exit(self, pose: SE2, library: Library, level: float) -> SE2:
        """Returns the pose after the step at an uncertainty level."""
        if self.to_trim is None:
            return pose @ SE2.exp(library.trim(self.trim).at(level), self.duration)
        return pose @ library.maneuver(self.trim, self.to_trim).at(level).displacement

    def time(self, library: Library, level: float) -> float:
        """Returns the seconds that the step takes at an uncertainty level."""
        if self.to_trim is None:
            return self.duration
        return library.maneuver(self.trim, self.to_trim).at(level).duration


@dataclass(frozen=True, slots=True)
class RemainingPlan:
    """The unflown part of a plan.

    Attributes:
        trim: id of the trim held now.
        coasts: seconds in that trim, and in each of those to come; empty where the plan is flown.
        trims: ids of the trims to come.
        tail: trim ids of the safe-stop path from the plan's end.
        is_safe_stop: True if only the safe-stop path remains.
    """

    trim: int
    coasts: tuple[float, ...] = ()
    trims: Walk = ()
    tail: Walk = ()
    is_safe_stop: bool = False

    @classmethod
    def of(cls, plan: Plan, scenario: Scenario) -> "RemainingPlan":
        """Returns the whole plan with the coasting times of one scenario."""
        return cls(plan.sequence[0], scenario.coasting_times, plan.sequence[1:], plan.tail)

    @property
    def finished(self) -> bool:
        """Returns True if no maneuver and no coasting time are left."""
        return not self.trims and sum(self.coasts) <= SHORTEST_COAST

    @property
    def maneuver_due(self) -> bool:
        """Returns True if the next step is a maneuver."""
        return bool(self.trims) and (not self.coasts or self.coasts[0] <= SHORTEST_COAST)

    def safe_stop(self) -> "RemainingPlan":
        """Returns the safe-stop path from the end of the plan."""
        return replace(
            self, coasts=(0.0,) * (len(self.tail) + 1), trims=self.tail, tail=(), is_safe_stop=True
        )

    def step(self, within: float) -> tuple[PlanStep, "RemainingPlan"]:
        """Returns the next step, at most so long, and the remainder."""
        if self.maneuver_due:
            step = PlanStep(self.trim, 0.0, self.trims[0])
            return step, replace(self, trim=self.trims[0], coasts=self.coasts[1:], trims=self.trims[1:])
        due = self.coasts[0] if self.coasts else 0.0
        time = within if not self.trims else min(within, due)
        coasts = (max(due - time, 0.0), *self.coasts[1:])
        return PlanStep(self.trim, time), replace(self, coasts=coasts)

    def window(self, duration: float) -> tuple[tuple[PlanStep, ...], "RemainingPlan"]:
        """Returns the steps of the coming seconds, up to a maneuver's end."""
        steps: list[PlanStep] = []
        left, time = self, duration
        while time > SHORTEST_COAST:
            step, left = left.step(time)
            steps.append(step)
            if step.to_trim is not None:
                break
            time -= step.duration
        return tuple(steps), left

    def predicted_end(self, pose: SE2, library: Library, level: float) -> tuple[SE2, float]:
        """Returns predicted end pose and time from a pose at a level."""
        left, elapsed = self, 0.0
        while not left.finished:
            step, left = left.step(left.coasts[0] if left.coasts else 0.0)
            pose, elapsed = step.exit(pose, library, level), elapsed + step.time(library, level)
        return pose, elapsed
