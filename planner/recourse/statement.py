"""Stated times of a mission under the policy with feedback."""

from collections import Counter
from math import inf, isfinite

import numpy as np

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.plan.policy_statement import Deadline, FirstDecision, PolicyStatement
from flight.se2 import SE2

from .cache import find_table
from .policy import FeedbackPolicy
from .rollouts import Rollouts, roll_out

ROLLOUTS = 4000
"""Rollouts behind stated times."""

SURE = 0.99
"""Probability of arriving in time below which a statement warns."""

SHORTEST_PATIENCE, ERROR_FREE_TIMES = 120.0, 5.0
"""Seconds, and error-free times, within which a flight should arrive."""


BELIEVED_DEVIATION = 0.05
"""Standard deviation in metres that the vehicle believes of its position; of `rtk` at most."""

CERTAINTY = 2.6
"""Of these it must be inside the goal's tolerance to declare arrival with probability 0.99."""


class GoalHeadingError(FlightError):
    """A goal with a heading, which the policy does not aim at."""

    def __init__(self, mission: str) -> None:
        super().__init__(f"mission {mission}: expected a goal without a heading for feedback, got one")


def declared_tolerance(tolerance: float) -> float:
    """Returns the metres from the goal within which arrival is declared.

    The table, the stated times and the declaration in flight all use it.

    Args:
        tolerance: of the mission, in metres.
    """
    return max(tolerance - CERTAINTY * BELIEVED_DEVIATION, 0.5 * tolerance)


def feedback_policy(library: Library, mission: Mission) -> FeedbackPolicy:
    """Returns the policy for a mission's goal.

    Raises:
        FlightError: the goal has no tolerance or a wanted heading, or there is no table for it.
    """
    if mission.destination.wants_heading:
        raise GoalHeadingError(mission.name)
    return FeedbackPolicy(
        library,
        find_table(library, tolerance=declared_tolerance(mission.tolerance), goal_trim=mission.goal_trim),
    )


def mission_rollouts(
    policy: FeedbackPolicy,
    mission: Mission,
    *,
    seed: int,
    latency: float = 0.0,
    count: int = ROLLOUTS,
    tracks: int = 0,
) -> Rollouts:
    """Returns rollouts of a mission.

    Args:
        policy: for the mission's goal.
        mission: from where to where.
        seed: of all chance.
        latency: seconds before a decision is acted on.
        count: number of rollouts.
        tracks: number of rollouts of which the way is kept.
    """
    seen = mission.start.inverse() @ SE2(*mission.goal, 0.0)
    rng = np.random.default_rng(seed)
    return roll_out(
        policy,
        trim=mission.start_trim,
        goal=(seen.x, seen.y),
        count=count,
        rng=rng,
        latency=latency,
        tracks=tracks,
    )


def state_policy(
    policy: FeedbackPolicy,
    mission: Mission,
    rollouts: Rollouts,
    *,
    seed: int,
    latency: float = 0.0,
    error_free_time: float,
    by: float | None = None,
) -> PolicyStatement:
    """Returns the statement about a mission.

    Args:
        policy: for the mission's goal.
        mission: from where to where.
        rollouts: of it.
        seed: of the rollouts.
        latency: of the rollouts.
        error_free_time: seconds of the best plan without errors; infinite where there is none.
        by: seconds for which the probability of arriving is wanted.
    """
    times = rollouts.times
    arrived = times[np.isfinite(times)]
    patience = max(
        SHORTEST_PATIENCE, ERROR_FREE_TIMES * error_free_time if isfinite(error_free_time) else 0.0
    )
    in_time = float(np.mean(times <= patience))
    choice = policy.decide(mission.start, mission.start_trim, mission.goal)
    (walk, often) = Counter(rollouts.walks).most_common(1)[0]
    return PolicyStatement(
        library=policy.library.name,
        library_hash=library_hash(policy.library),
        stated_mission=mission,
        tolerance=policy.table.problem.tolerance,
        latency=latency,
        table=policy.table.digest,
        rollouts=len(times),
        seed=seed,
        mean=_rounded(float(arrived.mean()) if len(arrived) else inf),
        median=_rounded(rollouts.quantile(0.5)),
        within_90=_rounded(rollouts.quantile(0.9)),
        within_95=_rounded(rollouts.quantile(0.95)),
        within_999=_rounded(rollouts.quantile(0.999)),
        patience=Deadline(round(patience, 3), in_time),
        deadline=None if by is None else Deadline(by, float(np.mean(times <= by))),
        first=FirstDecision(
            maneuver=None if choice.maneuver is None else choice.maneuver.id,
            value=round(choice.value, 6),
            runner_up=None if choice.runner_up is None else choice.runner_up.id,
            runner_up_value=_rounded(choice.runner_up_value),
        ),
        walk=walk,
        walk_share=often / len(times),
        reason=""
        if in_time >= SURE
        else f"only {100 * in_time:.1f} % of flights arrive within {patience:.0f} s",
    )


def _rounded(time: float) -> float | None:
    return round(time, 6) if isfinite(time) else None
