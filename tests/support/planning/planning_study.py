"""Odd missions planned by every policy, certified, and held to the reference."""

from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from time import perf_counter

import numpy as np

from flight.plan.plan import Plan
from planner.check.certificate_check import certificate_problems
from planner.commitment.committed import CommittedPlanner
from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from planner.proof.certify import ProofFailure, certify, provable_bound
from tests.oracles.coasting_problem import all_walks
from tests.oracles.committed_judgement import contradictions, judge_committed
from tests.oracles.plan_judgement import Judgement, judge, levels_of

from .odd_missions import OddCase, odd_case

COMPARED = 5
"""Every so many missions the committed policy and certificates are compared, too."""

FEW_WALKS = 10
"""Walks up to which they are."""

COMMITTED_NODES = 1000
"""Boxes that the committed policy may examine."""


@dataclass(slots=True)
class Tally:
    """Counts of planned missions, by outcome.

    Attributes:
        missions: how many.
        answers: plans by policy, status and how they compare with the reference.
        proofs: certificates by what came of them.
        faults: wrong answers, a line each.
        contradictions: between policies or with certificates, a line each.
        compared: missions on which these were compared.
        seconds: for all.
    """

    missions: int = 0
    answers: Counter[tuple[str, str, str]] = field(default_factory=Counter)
    proofs: Counter[str] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    contradictions: list[str] = field(default_factory=list)
    compared: int = 0
    seconds: float = 0.0

    def add(self, other: "Tally") -> None:
        """Adds another tally."""
        self.missions += other.missions
        self.answers += other.answers
        self.proofs += other.proofs
        self.faults += other.faults
        self.contradictions += other.contradictions
        self.compared += other.compared
        self.seconds += other.seconds

    def text(self) -> str:
        """Returns the tally for people, with the upper limit of what may go wrong unseen."""
        wrong = len(self.faults)
        lines = [f"{self.missions} missions, {self.missions / max(self.seconds, 1e-9) * 60:.0f} a minute"]
        lines += [
            f"  {policy:<11}{status:<11}{kind:<40}{count}"
            for (policy, status, kind), count in sorted(self.answers.items())
        ]
        lines += [f"  certificate: {what:<31}{count}" for what, count in sorted(self.proofs.items())]
        limit = f"at most {3 / max(self.missions, 1):.2g} of missions (95 %)" if not wrong else ""
        lines.append(f"{wrong} faults in {self.answers.total()} answers; {limit}")
        lines.append(f"{len(self.contradictions)} contradictions in {self.compared} missions compared")
        return "\n".join(lines + self.faults + self.contradictions)


def prove(seed: int, missions: int, *, processes: int = 2, chunk: int = 50) -> Tally:
    """Returns the tally of so many missions, from number 0, in processes side by side."""
    began = perf_counter()
    tally = Tally()
    parts = [(seed, begin, min(begin + chunk, missions)) for begin in range(0, missions, chunk)]
    if processes == 1:
        for part in parts:
            tally.add(tallied(*part))
    else:
        with ProcessPoolExecutor(processes) as pool:
            for done in pool.map(_tallied, parts):
                tally.add(done)
    tally.seconds = perf_counter() - began
    return tally


def _tallied(part: tuple[int, int, int]) -> Tally:
    return tallied(*part)


def tallied(seed: int, begin: int, end: int) -> Tally:
    """Returns the tally of missions of some numbers."""
    tally = Tally()
    for number in range(begin, end):
        _add_mission(tally, seed, number)
    return tally


def _add_mission(tally: Tally, seed: int, number: int) -> None:
    case = odd_case(seed, number)
    library, mission = case.library, case.mission
    tally.missions += 1
    plans = []
    for policy in ("nominal", "worst-case"):
        plan = planned(case, policy)
        rng = np.random.default_rng([seed, number, 1])
        found = judge(plan, library, mission, rng=rng, known=(case.walk, case.times))
        _note(tally, found, policy, f"odd_case({seed}, {number}) gamma {case.gamma!r}")
        plans.append(plan)
    nominal, worst = plans
    committed = None
    if number % COMPARED == 0 and len(all_walks(library, mission)) <= FEW_WALKS:
        tally.compared += 1
        committed = _committed(tally, case, seed, number)
        for plan in {nominal.policy: nominal, worst.policy: worst}.values():
            _certified(tally, plan, case, f"odd_case({seed}, {number})")
    tally.contradictions += [
        f"odd_case({seed}, {number}): {one}"
        for one in contradictions(nominal, worst, committed, library, mission)
    ]


def planned(case: OddCase, policy: str) -> Plan:
    """Returns the plan of the nominal or the worst-case policy."""
    planner = (
        nominal_planner(case.library) if policy == "nominal" else worst_case_planner(case.library, case.gamma)
    )
    return planner.plan(case.mission)


def _note(tally: Tally, found: Judgement, policy: str, where: str) -> None:
    plan, best = found.plan, found.reference
    tally.answers[policy, plan.status, found.kind] += 1
    if found.fault:
        tally.faults.append(
            f"{where} {policy}: {found.kind}: {plan.status} {plan.cost!r} s {plan.sequence}, "
            f"reference {best.cost!r} s {best.walk} {best.times}"
        )


def _committed(tally: Tally, case: OddCase, seed: int, number: int) -> Plan | None:
    if case.mission.tolerance == 0 or case.gamma == 0:
        return None
    planner = CommittedPlanner(case.library, case.gamma, max_nodes=COMMITTED_NODES)
    plan = planner.plan(case.mission)
    found = judge_committed(
        plan,
        case.library,
        case.mission,
        horizon=planner.horizon(case.mission),
        rng=np.random.default_rng([seed, number, 2]),
    )
    _note(tally, found, "committed", f"odd_case({seed}, {number}) gamma {case.gamma!r}")
    return plan


def _certified(tally: Tally, plan: Plan, case: OddCase, where: str) -> None:
    if plan.status not in ("optimal", "infeasible"):
        return
    levels, bound = levels_of(plan), provable_bound(plan.cost)
    proof = certify(case.library, case.mission, levels, bound)
    if not isinstance(proof, ProofFailure):
        wrong = certificate_problems(proof, case.library, case.mission, gammas=levels, lower_bound=bound)
        tally.proofs["holds" if not wrong else "fails its check"] += 1
        tally.contradictions += [f"{where} {plan.policy}: {one}" for one in wrong]
        return
    tally.proofs["faster walk" if proof.reached else "stopped"] += 1
    if proof.reached:
        tally.contradictions.append(f"{where} {plan.policy}: {plan.status}, certify finds {proof}")
