"""Policy with feedback for one mission: table, statement, flight."""

from collections.abc import Callable
from dataclasses import dataclass

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg, Vehicle
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.plan.policy_statement import PolicyStatement, statement_text
from planner.closed_loop.feedback_loop import fly_with_feedback
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.settings import Settings
from planner.policies.nominal import nominal_planner
from planner.recourse.policy import FeedbackPolicy
from planner.recourse.rollouts import Rollouts
from planner.recourse.statement import feedback_policy, mission_rollouts, state_policy

FEEDBACK = "feedback"
"""Name of the policy."""

DEFAULT_LATENCY = Settings().latency.configured
"""Seconds of latency that times are stated with, as flights have it."""

STATEMENT_SEED = 1
"""Seed of the rollouts behind stated times; never that of a flight."""


class MeasuredLatencyError(FlightError):
    """A measured latency for decisions that are looked up."""

    def __init__(self) -> None:
        super().__init__("expected a latency in s for the policy with feedback, got measured")


@dataclass(frozen=True, slots=True, eq=False)
class StatedPolicy:
    """A policy with feedback, and what it states about a mission.

    Attributes:
        policy: for the mission's goal.
        statement: its times.
        rollouts: behind them.
    """

    policy: FeedbackPolicy
    statement: PolicyStatement
    rollouts: Rollouts

    @property
    def attachment(self) -> bytes:
        """Statement as it stands in a flight's log."""
        return statement_text(self.statement).encode()

    def fly(
        self,
        vehicle: Vehicle,
        mission: Mission,
        settings: Settings,
        on_leg: Callable[[Leg], None] | None = None,
    ) -> FlightRecord:
        """Flies the mission; overdue flights go on by nominal plans.

        Raises:
            MeasuredLatencyError: the latency is to be measured.
        """
        if settings.latency.measured:
            raise MeasuredLatencyError
        return fly_with_feedback(
            vehicle,
            mission,
            policy=self.policy,
            statement=self.statement,
            otherwise=nominal_planner(self.policy.library),
            settings=settings,
            on_leg=on_leg,
        )


def stated_policy(
    library: Library,
    mission: Mission,
    *,
    seed: int = STATEMENT_SEED,
    latency: float = DEFAULT_LATENCY,
    by: float | None = None,
    tracks: int = 0,
) -> StatedPolicy:
    """Returns the policy for a mission with its statement.

    Args:
        library: the primitives.
        mission: with the tolerance that flights are judged by.
        seed: of the rollouts.
        latency: seconds before a decision is acted on.
        by: seconds for which the probability of arriving is wanted.
        tracks: number of rollouts of which the way is kept.

    Raises:
        FlightError: there is no table for the goal.
    """
    policy = feedback_policy(library, mission)
    rollouts = mission_rollouts(policy, mission, seed=seed, latency=latency, tracks=tracks)
    error_free = nominal_planner(library).plan(mission).cost
    statement = state_policy(
        policy, mission, rollouts, seed=seed, latency=latency, error_free_time=error_free, by=by
    )
    return StatedPolicy(policy, statement, rollouts)
