"""`maneuver plan --policy feedback`: stated times instead of a plan, and their check."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from experiments.mission.feedback import STATEMENT_SEED, StatedPolicy, stated_policy
from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.automaton.maneuver import Maneuver
from flight.mission.mission import Mission
from flight.plan.policy_statement import PolicyStatement, statement_text
from planner.check.policy_rollouts import Situation, arrival_times, statement_problems
from planner.recourse.statement import declared_tolerance, feedback_policy
from runtime.atomic_write import write_atomically

from .prices import png_bytes

NO_PLAN = 1

FAN = 200
"""Rollouts drawn."""

_CHECKED_FLIGHTS = 500


def state_times(
    library: Library,
    mission: Mission,
    *,
    by: float | None,
    out: Path | None,
    picture: Path | None,
    replace_out: bool,
    force: bool,
    json: bool,
) -> int:
    """Prints, writes and draws the stated times of a mission.

    Args:
        library: the primitives.
        mission: the mission.
        by: seconds for which the probability of arriving is wanted.
        out: file for the statement.
        picture: file for the picture.
        replace_out: overwrite the statement's file.
        force: overwrite the picture.
        json: print the statement as JSON.
    """
    answer = stated_policy(library, mission, by=by, tracks=FAN)
    text = statement_text(answer.statement)
    if out is not None:
        write_atomically(text.encode(), out, force=replace_out)
    if picture is not None:
        from experiments.validation.policy_picture import policy_picture

        write_atomically(png_bytes(policy_picture(answer, mission)), picture, force=force)
    if json:
        sys.stdout.write(text)
    else:
        _print(answer, library)
    return 0 if answer.statement.found else NO_PLAN


def _print(answer: StatedPolicy, library: Library) -> None:
    said = answer.statement
    mission = said.stated_mission
    print(f"{mission.name} on {said.library}: feedback, {_seconds(said.mean)} on average")
    shares = (("half", said.median), ("90 %", said.within_90), ("95 %", said.within_95))
    words = [f"{share} within {_seconds(time)}" for share, time in (*shares, ("99.9 %", said.within_999))]
    print(f"of {said.rollouts} flights rolled out: {', '.join(words)}")
    if said.deadline is not None:
        print(f"within {said.deadline.time:g} s: {100 * said.deadline.probability:.1f} %")
    first, runner_up = _action(said.first.maneuver, library), _action(said.first.runner_up, library)
    second = "" if said.first.runner_up_value is None else f"; {runner_up} {said.first.runner_up_value:.2f} s"
    print(f"first decision: {first}, {said.first.value:.2f} s expected{second}")
    walk = ", ".join(map(str, said.walk))
    print(f"most likely walk: trims {walk} ({100 * said.walk_share:.0f} % of flights)")
    print(f"arrival is declared {said.tolerance:.3f} m from the goal; table {said.table[:12]}")
    if said.reason:
        print(said.reason)


def _seconds(time: float | None) -> str:
    return "no time" if time is None else f"{time:.2f} s"


def _action(maneuver: int | None, library: Library) -> str:
    if maneuver is None:
        return "coast"
    step = next(one for one in library.maneuvers if one.id == maneuver)
    return f"maneuver {maneuver} to trim {step.to_trim}"


def statement_faults(statement: PolicyStatement, library: Library) -> tuple[str, ...]:
    """Returns contradictions of a statement to its library, table or rollouts.

    The policy is rolled out anew by code that shares nothing with the planner but the decisions.

    Args:
        statement: of a file.
        library: to be judged with.
    """
    mission = statement.stated_mission
    if statement.library_hash != library_hash(library):
        return (f"library_hash: expected that of {library.name}, {library_hash(library)}",)
    if statement.tolerance != declared_tolerance(mission.tolerance):
        return (
            f"tolerance: expected {declared_tolerance(mission.tolerance)} m, got {statement.tolerance} m",
        )
    policy = feedback_policy(library, mission)
    if statement.table != policy.table.digest:
        return (f"table: expected {policy.table.digest}, got {statement.table}",)

    def decide(now: Situation) -> Maneuver | None:
        return policy.decide(
            now.pose, now.trim, mission.goal, coasted=now.coasted, previous=now.previous, offset=now.offset
        ).maneuver

    rng = np.random.default_rng(statement.seed + STATEMENT_SEED)
    declared = replace(mission, tolerance=statement.tolerance)
    return statement_problems(
        statement,
        arrival_times(decide, library, declared, count=_CHECKED_FLIGHTS, rng=rng, latency=statement.latency),
    )
