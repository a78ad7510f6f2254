"""A motion plan: a walk in the maneuver automaton with its coasting times, and what it promises."""

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import inf
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, FiniteFloat, NonNegativeFloat, PositiveInt

from flight.errors import BadFileError
from flight.schema import FileModel, parse_json, read_text, schema_named
from flight.se2 import SE2

from .certificate import Certificate, InfeasibilityCertificate
from .time_bound import TimeBound, TimeBoundPart

Status = Literal["optimal", "feasible", "infeasible", "unknown"]
Policy = Literal["nominal", "worst-case", "committed", "price-of-robustness"]

SCHEMA = "maneuver-plan/1"


class PlanContradictionError(BadFileError):
    """A plan file is well formed, but what it says in one place is not what it says in another."""


@dataclass(frozen=True, slots=True)
class Scenario:
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


@dataclass(frozen=True, slots=True)
class Plan:
    """The answer to a mission, or an honest no.

    Attributes:
        status: `optimal`, `feasible` (not proved the best), `infeasible` (proved), `unknown`.
        library: name of the library planned with.
        library_hash: SHA-256 of the library's text.
        mission: name of the mission.
        policy: which planner.
        gamma: uncertainty level planned for.
        tolerance: radius around the goal in metres that was planned with.
        sequence: trim ids; empty without a plan.
        maneuvers: maneuver ids between them.
        scenarios: one for each uncertainty level considered, the deciding one among them.
        verified: whether code that shares nothing with the solver flew every scenario to the goal.
        reason: why there is no plan, or why it is not called optimal.
        lower_bound: seconds that no plan can undercut, where known.
        certificate: proof of the lower bound, or that there is no plan, where asked for.
        solve_time: seconds of computing; outside every hash.
        tail: ids of the trims that lead from the last one to rest, for when nothing better comes.
        alpha: worst-case time accepted, in nominal optima, where the policy knows a price.
        miss: metres that the end misses the goal by at most, whatever the level between -gamma and gamma;
            where one set of coasting times is flown at all of them.
        time_promise: which share of flights keeps which multiple of the cost, where that was found by flying.
        at_smallest_tolerance: where no such set exists, the plan for the smallest tolerance for which one
            does.
    """

    status: Status
    library: str
    library_hash: str
    mission: str
    policy: Policy
    gamma: float
    tolerance: float
    sequence: tuple[int, ...] = ()
    maneuvers: tuple[int, ...] = ()
    scenarios: tuple[Scenario, ...] = ()
    verified: bool = False
    reason: str = ""
    lower_bound: float | None = None
    certificate: Certificate | None = None
    solve_time: float = 0.0
    alpha: float | None = None
    tail: tuple[int, ...] = ()
    miss: float | None = None
    time_promise: TimeBound | None = None
    at_smallest_tolerance: "Plan | None" = None

    @property
    def found(self) -> bool:
        """Whether there is something to fly."""
        return bool(self.scenarios)

    @property
    def deciding(self) -> Scenario:
        """The scenario with the largest cost; its coasting times are the ones flown.

        Raises:
            ValueError: there is no plan.
        """
        return max(self.scenarios, key=lambda scenario: scenario.cost)

    @property
    def cost(self) -> float:
        """Seconds that the deciding scenario takes; infinite without a plan."""
        return self.deciding.cost if self.found else inf

    @property
    def coasting_times(self) -> tuple[float, ...]:
        """Seconds in each trim in the deciding scenario; empty without a plan."""
        return self.deciding.coasting_times if self.found else ()


class _Pose(FileModel):
    x: FiniteFloat
    y: FiniteFloat
    heading: FiniteFloat


class _Scenario(FileModel):
    gamma: FiniteFloat
    cost: FiniteFloat
    coasting_times: tuple[FiniteFloat, ...]
    end: _Pose


class _InfeasibilityCertificate(FileModel):
    sequence: tuple[int, ...]
    gamma: FiniteFloat
    tree: str


class _Certificate(FileModel):
    max_trims: PositiveInt
    refutations: tuple[_InfeasibilityCertificate, ...]


class _PlanFile(FileModel):
    schema_name: Annotated[str, schema_named(SCHEMA)] = Field(alias="schema")
    status: Status
    reason: str | None = None
    library: str
    library_hash: str
    mission: str
    policy: Policy
    gamma: FiniteFloat
    tolerance: FiniteFloat
    cost: FiniteFloat | None = None
    sequence: tuple[int, ...]
    maneuvers: tuple[int, ...]
    coasting_times: tuple[FiniteFloat, ...]
    scenarios: tuple[_Scenario, ...]
    lower_bound: FiniteFloat | None = None
    certificate: _Certificate | None = None
    verified: bool
    solve_time: NonNegativeFloat
    tail: tuple[int, ...] = ()
    alpha: FiniteFloat | None = None
    miss: NonNegativeFloat | None = None
    time_promise: TimeBoundPart | None = None
    at_smallest_tolerance: "_PlanFile | None" = None


def plan_content(plan: Plan) -> dict[str, Any]:
    """Returns the plan as plain JSON values, in the order of its schema."""
    content = {
        "schema": SCHEMA,
        "status": plan.status,
        "reason": plan.reason or None,
        "library": plan.library,
        "library_hash": plan.library_hash,
        "mission": plan.mission,
        "policy": plan.policy,
        "gamma": plan.gamma,
        "alpha": plan.alpha,
        "tolerance": plan.tolerance,
        "cost": plan.cost if plan.found else None,
        "sequence": list(plan.sequence),
        "maneuvers": list(plan.maneuvers),
        "coasting_times": list(plan.coasting_times),
        "scenarios": [_scenario_content(scenario) for scenario in plan.scenarios],
        "tail": list(plan.tail) or None,
        "miss": plan.miss,
        "time_promise": None if plan.time_promise is None else asdict(plan.time_promise),
        "lower_bound": plan.lower_bound,
        "certificate": None if plan.certificate is None else _certificate_content(plan.certificate),
        "verified": plan.verified,
        "solve_time": plan.solve_time,
        "at_smallest_tolerance": plan.at_smallest_tolerance and plan_content(plan.at_smallest_tolerance),
    }
    return {key: value for key, value in content.items() if value is not None}


def plan_text(plan: Plan) -> str:
    """Returns the plan as its file's text."""
    return json.dumps(plan_content(plan), indent=2, allow_nan=False) + "\n"


def read_plan(path: Path) -> Plan:
    """Reads a plan file.

    Raises:
        BadFileError: the file is missing or broken; names the place.
        PlanContradictionError: it is whole, but contradicts itself; names the place.
    """
    plan, content = parse_json(read_text(path), path, _PlanFile, lambda content: (_to_plan(content), content))
    for contradiction in _contradictions(plan, content):
        raise PlanContradictionError(path, contradiction)
    return plan


def _certificate_content(certificate: Certificate) -> dict[str, Any]:
    return {
        "max_trims": certificate.max_trims,
        "refutations": [
            {"sequence": list(one.sequence), "gamma": one.gamma, "tree": one.tree}
            for one in certificate.refutations
        ],
    }


def _scenario_content(scenario: Scenario) -> dict[str, Any]:
    return {
        "gamma": scenario.gamma,
        "cost": scenario.cost,
        "coasting_times": list(scenario.coasting_times),
        "end": {"x": scenario.end.x, "y": scenario.end.y, "heading": scenario.end.heading},
    }


def _to_plan(content: _PlanFile) -> Plan:
    return Plan(
        status=content.status,
        library=content.library,
        library_hash=content.library_hash,
        mission=content.mission,
        policy=content.policy,
        gamma=content.gamma,
        tolerance=content.tolerance,
        sequence=content.sequence,
        maneuvers=content.maneuvers,
        scenarios=tuple(
            Scenario(
                part.gamma, part.cost, part.coasting_times, SE2(part.end.x, part.end.y, part.end.heading)
            )
            for part in content.scenarios
        ),
        verified=content.verified,
        reason=content.reason or "",
        lower_bound=content.lower_bound,
        alpha=content.alpha,
        tail=content.tail,
        miss=content.miss,
        time_promise=None if content.time_promise is None else content.time_promise.promise(),
        certificate=None if content.certificate is None else _to_certificate(content.certificate),
        solve_time=content.solve_time,
        at_smallest_tolerance=_to_plan(wider) if (wider := content.at_smallest_tolerance) else None,
    )


def _to_certificate(content: _Certificate) -> Certificate:
    refutations = tuple(
        InfeasibilityCertificate(one.sequence, one.gamma, one.tree) for one in content.refutations
    )
    return Certificate(content.max_trims, refutations)


def _contradictions(plan: Plan, content: _PlanFile) -> Iterator[str]:
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
    if content.cost != (plan.cost if plan.found else None):
        yield f"cost: the deciding scenario takes {plan.cost} s, got {content.cost} s"
    if content.coasting_times != plan.coasting_times:
        yield "coasting_times: those of the deciding scenario, got others"
    wider, its_content = plan.at_smallest_tolerance, content.at_smallest_tolerance
    if wider is not None and its_content is not None:
        for contradiction in _contradictions(wider, its_content):
            yield f"at_smallest_tolerance.{contradiction}"
    if plan.verified != plan.found:
        yield f"verified: expected {plan.found} where the status is {plan.status}, got {plan.verified}"
    if plan.tolerance < 0:
        yield f"tolerance: must be >= 0 m, got {plan.tolerance} m"
