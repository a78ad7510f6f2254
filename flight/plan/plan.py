"""Motion plan: a walk in the automaton with its coasting times."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import inf, isinf
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, NonNegativeFloat

from flight.errors import BadFileError
from flight.file_value import FileValue, Omittable
from flight.mission.mission import Mission, check_file_limits
from flight.schema import json_content, parse_json, read_text, refusing, schema_named
from flight.se2 import SE2

from .certificate import Certificate
from .time_bound import TimeBound

Status = Literal["optimal", "feasible", "infeasible", "unknown"]
Policy = Literal["nominal", "worst-case", "committed", "price-of-robustness"]

SCHEMA = "maneuver-plan/2"
"""Of a plan that carries its mission, as files do."""

SCHEMA_WITHOUT_MISSION = "maneuver-plan/1"
"""Of a plan that names its mission only: those in logs, beside the mission, and older files."""


class PlanContradictionError(BadFileError):
    """Plan file that contradicts itself."""


@dataclass(frozen=True, slots=True)
class Scenario(FileValue):
    """The plan's walk flown at one uncertainty level.

    Attributes:
        gamma: the level.
        cost: seconds to the goal.
        coasting_times: seconds, one for each trim.
        end: pose at the end.
    """

    gamma: float
    cost: float
    coasting_times: tuple[float, ...]
    end: SE2


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan(FileValue):
    """Plan for a mission, or the reason that there is none.

    Attributes:
        schema: name of the file's schema.
        status: `optimal`, `feasible` (not proved the best), `infeasible` (proved), `unknown`.
        reason: reason if there is no plan, or if it is not proved optimal.
        library: name of the library planned with.
        library_hash: SHA-256 of the library's text.
        mission: name of the mission.
        stated_mission: the mission planned for; None if only its name is known.
        policy: planning policy.
        gamma: uncertainty level planned for.
        alpha: accepted worst-case time over the nominal optimum, for price-of-robustness plans.
        tolerance: radius around the goal in metres.
        cost: time of the deciding scenario in seconds; infinite without a plan.
        sequence: trim ids; empty without a plan.
        maneuvers: maneuver ids between them.
        coasting_times: seconds in each trim in the deciding scenario; empty without a plan.
        scenarios: one for each uncertainty level considered, the deciding one among them.
        tail: trim ids of the safe-stop path from the last trim, flown without a newer plan.
        miss: metres that the end misses the goal by at most, whatever the level between -gamma and gamma;
            where one set of coasting times is flown at all of them.
        time_promise: time bound from validation flights, if any.
        lower_bound: lower bound of any plan's time in seconds, if known.
        certificate: proof of the lower bound, or that there is no plan, if requested.
        verified: True if code independent of the solver confirmed that every scenario ends at the goal.
        solve_time: computing time in seconds; outside every hash.
        at_smallest_tolerance: if no such set exists, the plan for the smallest tolerance for which one
            does.
    """

    schema: Annotated[str, schema_named(SCHEMA, SCHEMA_WITHOUT_MISSION)] = field(
        init=False, default=SCHEMA, repr=False
    )
    status: Status
    reason: Omittable[str] = ""
    library: str
    library_hash: str
    mission: str
    stated_mission: Mission | None = None
    policy: Policy
    gamma: float
    alpha: float | None = None
    tolerance: float
    cost: Annotated[float, Field(exclude_if=isinf)] = field(init=False, default=inf)
    sequence: tuple[int, ...] = ()
    maneuvers: tuple[int, ...] = ()
    coasting_times: tuple[float, ...] = field(init=False, default=())
    scenarios: tuple[Scenario, ...] = ()
    tail: Omittable[tuple[int, ...]] = ()
    miss: NonNegativeFloat | None = None
    time_promise: TimeBound | None = None
    lower_bound: float | None = None
    certificate: Certificate | None = None
    verified: bool = False
    solve_time: NonNegativeFloat = 0.0
    at_smallest_tolerance: "Plan | None" = None

    def __post_init__(self) -> None:
        """Sets schema, cost and coasting times from the other fields."""
        schema = SCHEMA_WITHOUT_MISSION if self.stated_mission is None else SCHEMA
        object.__setattr__(self, "schema", schema)
        object.__setattr__(self, "cost", self.deciding.cost if self.found else inf)
        object.__setattr__(self, "coasting_times", self.deciding.coasting_times if self.found else ())

    @property
    def found(self) -> bool:
        """True if the plan has a walk to fly."""
        return bool(self.scenarios)

    @property
    def deciding(self) -> Scenario:
        """Scenario with the largest cost; its coasting times are flown.

        Raises:
            ValueError: there is no plan.
        """
        return max(self.scenarios, key=lambda scenario: scenario.cost)

    @property
    def empty(self) -> bool:
        """True where the plan has nothing to fly and proves nothing."""
        return not self.found and self.certificate is None and self.at_smallest_tolerance is None


def with_mission(plan: Plan, mission: Mission) -> Plan:
    """Returns the plan with its mission, so that its file is complete."""
    wider = plan.at_smallest_tolerance
    if wider is not None:
        wider = with_mission(wider, replace(mission, tolerance=wider.tolerance))
    return replace(plan, stated_mission=mission, at_smallest_tolerance=wider)


def plan_text(plan: Plan) -> str:
    """Returns the plan as its file's text."""
    return json.dumps(json_content(plan), indent=2, allow_nan=False) + "\n"


def read_plan(path: Path) -> Plan:
    """Reads a plan file.

    Raises:
        BadFileError: the file is missing or broken; names the place.
        PlanContradictionError: it is whole, but contradicts itself; names the place.
    """
    text = read_text(path)
    plan = parse_json(text, path, Plan)
    with refusing(path):
        _check_mission(plan, json.loads(text)["schema"])
    for contradiction in _contradictions(plan, json.loads(text)):
        raise PlanContradictionError(path, contradiction)
    return plan


def _check_mission(plan: Plan, schema: str) -> None:
    """Checks that a plan holds a mission if its schema requires one."""
    if plan.schema != schema:
        problem = "is missing" if plan.stated_mission is None else f"expected none in {schema}, got one"
        raise ValueError(f"stated_mission: {problem}")
    if plan.stated_mission is not None:
        check_file_limits(plan.stated_mission)
    if plan.at_smallest_tolerance is not None and plan.at_smallest_tolerance.schema != schema:
        raise ValueError(f"at_smallest_tolerance.schema: expected {schema}, as of the plan itself")


def _contradictions(plan: Plan, stated: Mapping[str, Any]) -> Iterator[str]:
    """Returns where a plan's parts do not fit together."""
    if plan.found != (plan.status in {"optimal", "feasible"}):
        yield f"scenarios: a plan that is {plan.status} has {'some' if not plan.found else 'none'}"
    joints = max(len(plan.sequence) - 1, 0)
    if len(plan.maneuvers) != joints:
        yield f"maneuvers: expected {joints} between {len(plan.sequence)} trims, got {len(plan.maneuvers)}"
    for place, scenario in enumerate(plan.scenarios):
        if len(scenario.coasting_times) != len(plan.sequence):
            yield f"scenarios[{place}].coasting_times: one for each of {len(plan.sequence)} trims"
        if min(scenario.coasting_times, default=0.0) < 0:
            yield f"scenarios[{place}].coasting_times: must be >= 0 s, got {scenario.coasting_times}"
    if stated.get("cost", inf) != plan.cost:
        yield f"cost: the deciding scenario takes {plan.cost} s, got {stated.get('cost')} s"
    if tuple(stated["coasting_times"]) != plan.coasting_times:
        yield "coasting_times: those of the deciding scenario, got others"
    if plan.at_smallest_tolerance is not None:
        for contradiction in _contradictions(plan.at_smallest_tolerance, stated["at_smallest_tolerance"]):
            yield f"at_smallest_tolerance.{contradiction}"
    if plan.verified != plan.found:
        yield f"verified: expected {plan.found} where the status is {plan.status}, got {plan.verified}"
    mission = plan.stated_mission
    if mission is not None and (mission.name, mission.tolerance) != (plan.mission, plan.tolerance):
        yield (
            f"stated_mission: expected {plan.mission} to {plan.tolerance} m, "
            f"got {mission.name} to {mission.tolerance} m"
        )
    if plan.tolerance < 0:
        yield f"tolerance: must be >= 0 m, got {plan.tolerance} m"
