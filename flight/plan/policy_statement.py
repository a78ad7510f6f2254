"""Statement of a policy with feedback about one mission.

A policy has no walk with coasting times: it decides in flight. What it states is how long flights take.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveInt

from flight.file_value import FileValue, Omittable, Share
from flight.mission.mission import Mission, check_file_limits
from flight.schema import json_content, parse_json, read_text, refusing, schema_named

SCHEMA = "maneuver-policy/1"


@dataclass(frozen=True, slots=True)
class FirstDecision(FileValue):
    """Decision of a policy at the start.

    Attributes:
        value: expected seconds to the goal.
        maneuver: id of the maneuver to perform; None to coast.
        runner_up: id of the second best maneuver; None for a coast, or where there is none.
        runner_up_value: expected seconds by it; None where there is none.
    """

    value: float
    maneuver: int | None = None
    runner_up: int | None = None
    runner_up_value: float | None = None


@dataclass(frozen=True, slots=True)
class Deadline(FileValue):
    """Probability of arriving within a time in seconds."""

    time: float
    probability: Share


@dataclass(frozen=True, slots=True, kw_only=True)
class PolicyStatement(FileValue):
    """Times that flights of one mission take under a policy with feedback.

    Attributes:
        schema: of its file.
        library: name of the library.
        library_hash: SHA-256 of the library's text.
        stated_mission: the mission.
        policy: `feedback`.
        tolerance: metres from the goal within which arrival is declared; inside the mission's tolerance.
        latency: seconds before a decision is acted on, at the start and after every maneuver.
        table: SHA-256 of the table of costs.
        rollouts: number of flights rolled out by the library's law.
        seed: of their chance.
        mean: seconds to the goal, over those that arrive; None where none does.
        median: seconds within which half of all arrive; None where fewer do, as below.
        within_90: seconds within which 90 % arrive.
        within_95: seconds within which 95 % arrive.
        within_999: seconds within which 99.9 % arrive.
        patience: arrival probability within the larger of 120 s and five times the error-free time.
        deadline: arrival probability within a time that was asked for.
        first: the first decision.
        walk: trim ids of the most likely walk.
        walk_share: share of rollouts that take it.
        reason: warning where the arrival is not sure.
    """

    schema: Annotated[str, schema_named(SCHEMA)] = field(init=False, default=SCHEMA, repr=False)
    library: str
    library_hash: str
    stated_mission: Mission
    policy: Literal["feedback"] = "feedback"
    tolerance: NonNegativeFloat
    latency: NonNegativeFloat
    table: str
    rollouts: PositiveInt
    seed: NonNegativeInt
    mean: NonNegativeFloat | None = None
    median: NonNegativeFloat | None = None
    within_90: NonNegativeFloat | None = None
    within_95: NonNegativeFloat | None = None
    within_999: Annotated[
        NonNegativeFloat | None, Field(description="seconds within which 99.9 % arrive")
    ] = None
    patience: Deadline
    deadline: Deadline | None = None
    first: FirstDecision
    walk: tuple[int, ...]
    walk_share: Share
    reason: Omittable[str] = ""

    @property
    def found(self) -> bool:
        """True where flights arrive at all."""
        return self.mean is not None


def statement_text(statement: PolicyStatement) -> str:
    """Returns a statement as its file's text."""
    return json.dumps(json_content(statement), indent=2, allow_nan=False) + "\n"


def is_statement(path: Path) -> bool:
    """Returns True where a file names the schema of a statement.

    Raises:
        BadFileError: the file cannot be read.
    """
    return f'"{SCHEMA}"' in read_text(path)[:200]


def read_statement(path: Path) -> PolicyStatement:
    """Reads a statement.

    Raises:
        BadFileError: the file is missing or broken; names the place.
    """
    statement = parse_json(read_text(path), path, PolicyStatement)
    with refusing(path):
        check_file_limits(statement.stated_mission)
    return statement
