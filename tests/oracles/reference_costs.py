"""Costs of odd missions as the reference finds them, kept: `python -m tests.oracles.reference_costs 1500`.

Kept are missions on which planner and reference agree; where the way in which missions are drawn changes, the
file has to be written anew.
"""

import csv
import sys
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from hashlib import sha256
from math import inf
from pathlib import Path

import numpy as np

from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from tests.support.planning.odd_missions import OddCase, odd_case

from .plan_judgement import judge

FILE = Path(__file__).parent.parent / "data" / "odd_missions.csv"

SEED = 7
"""Of the missions in the file."""

AGREED = ("same", "no plan")
"""Judgements of missions that are kept."""


@dataclass(frozen=True, slots=True)
class ReferenceCosts:
    """Costs of one mission.

    Attributes:
        number: of the mission.
        digest: of its library and its mission.
        nominal: seconds; infinite where there is no plan.
        worst_case: seconds at the level that takes longest.
    """

    number: int
    digest: str
    nominal: float
    worst_case: float


def digest(case: OddCase) -> str:
    """Returns eight digits that tell one case from another."""
    return sha256(
        repr((case.library.trims, case.library.maneuvers, case.mission, case.gamma))
        .replace(", law=None", "")
        .encode()
    ).hexdigest()[:8]


def read_costs() -> list[ReferenceCosts]:
    """Returns the missions in the file."""
    with FILE.open(newline="") as file:
        return [
            ReferenceCosts(int(number), digits, float(nominal), float(worst))
            for number, digits, nominal, worst in csv.reader(file)
        ]


def _costs(number: int) -> ReferenceCosts | None:
    case = odd_case(SEED, number)
    known = (case.walk, case.times)
    found = []
    for planner in (nominal_planner(case.library), worst_case_planner(case.library, case.gamma)):
        rng = np.random.default_rng([SEED, number, 1])
        one = judge(planner.plan(case.mission), case.library, case.mission, rng=rng, known=known)
        if one.kind not in AGREED:
            return None
        found.append(min(one.reference.cost, one.plan.cost) if one.plan.found else inf)
    return ReferenceCosts(number, digest(case), *found)


def main(missions: int) -> None:
    """Writes the file."""
    with ProcessPoolExecutor(2) as pool, FILE.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        for one in pool.map(_costs, range(missions), chunksize=20):
            if one is not None:
                writer.writerow([one.number, one.digest, f"{one.nominal:.9g}", f"{one.worst_case:.9g}"])


if __name__ == "__main__":
    main(int(sys.argv[1]))
