"""`maneuver library audit`: test of the sign convention on random missions."""

import json as json_module
import sys
from collections import defaultdict
from dataclasses import asdict
from itertools import pairwise
from math import isfinite
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from scipy.stats import binomtest

from flight.automaton.library import Library
from flight.automaton.sign_convention import signed_maneuver_error, signed_trim_error
from flight.plural import plural
from maneuver.options.numbers import Count, Seed
from planner.independent_errors.monotonicity_audit import (
    GAMMAS,
    MonotonicityAudit,
    PrimitiveScalar,
    TimeIncrease,
)
from planner.independent_errors.monotonicity_audit import audit_monotonicity as audit_signs
from scenarios.find import find_library

SHOWN = 12


def audit(
    library: str,
    /,
    *,
    missions: Count = 5000,
    seed: Seed = 1,
    max_trims: Count = 4,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Counts random missions whose optimal time never rises with gamma.

    By the sign convention, gamma = +1 means fast and wide, so a mission should take least time at gamma = +1
    and most at gamma = -1. The optimal time of each mission is computed at gamma -1, 0 and +1. Where it
    rises, the table names the error that causes the largest part of the rise on the previously optimal walk.

    For example:

        maneuver library audit gtmax-sim

        maneuver library audit thesis-kinematic --missions 500 --json

    Args:
        library: name or path.
        missions: number of random missions.
        seed: seed of the missions.
        max_trims: number of trims in the longest walk searched.
        json: print every rise as JSON.
    """
    found = find_library(library)
    result = audit_signs(found, missions=missions, seed=seed, max_trims=max_trims)
    if json:
        text = json_module.dumps(asdict(result), indent=2).replace("Infinity", "null")
        sys.stdout.write(text + "\n")
        return 0
    if not result.reachable:
        print(f"{found.name}: none of {result.missions} missions has a plan")
        return 0
    interval = binomtest(result.monotone, result.reachable).proportion_ci(0.95, method="wilson")
    share = _share(result.monotone, result.reachable)
    print(
        f"{found.name}: {plural(result.missions, 'mission')}, {result.reachable} with a plan; "
        f"optimal time never rises with gamma in {result.monotone} ({share}; 95 %: "
        f"{100 * interval.low:.1f}-{100 * interval.high:.1f} %)"
    )
    for levels in pairwise(GAMMAS):
        rises = [rise for rise in result.rises if rise.gammas == levels]
        lost = sum(not isfinite(rise.times[1]) for rise in rises)
        print(
            f"gamma {levels[0]:g} to {levels[1]:g}: rises in {len(rises)} "
            f"({_share(len(rises), result.reachable)}), {lost} of them because the goal becomes unreachable"
        )
    Console(highlight=False).print(_table(found, result))
    return 0


def _share(part: int, whole: int) -> str:
    return f"{100 * part / max(whole, 1):.1f} %"


def _table(library: Library, result: MonotonicityAudit) -> Table:
    by_number: defaultdict[PrimitiveScalar | None, list[TimeIncrease]] = defaultdict(list)
    for rise in result.rises:
        by_number[rise.culprit].append(rise)
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("cause", "signed by the rule", "rises", "median, s"):
        table.add_column(
            heading, justify="right" if heading in ("rises", "median, s") else "left", no_wrap=True
        )
    ranked = sorted(by_number.items(), key=lambda item: -len(item[1]))
    for number, rises in ranked[:SHOWN]:
        sizes = sorted(rise.times[1] - rise.times[0] for rise in rises)
        words = "several together" if number is None else _describe(library, number)
        ruled = "" if number is None else ("yes" if _by_the_rule(library, number) else "no")
        table.add_row(words, ruled, str(len(rises)), f"{sizes[len(sizes) // 2]:.3f}")
    rest = sum(len(rises) for _, rises in ranked[SHOWN:])
    if rest:
        table.add_row(plural(len(ranked) - SHOWN, "other"), "", str(rest), "")
    return table


def _describe(library: Library, number: PrimitiveScalar) -> str:
    name = number.name.replace("_", " ")
    if number.kind == "trim":
        return f"trim {number.id} ({library.trim(number.id).name}): {name}"
    row = next(row for row in library.maneuvers if row.id == number.id)
    return f"maneuver {number.id} ({row.from_trim}-{row.to_trim}): {name}"


def _by_the_rule(library: Library, number: PrimitiveScalar) -> bool:
    """Returns True where an error has the convention's sign."""
    if number.kind == "trim":
        trim = library.trim(number.id)
        return bool(
            getattr(trim.error, number.name)
            == getattr(signed_trim_error(trim.error, trim.velocity), number.name)
        )
    row = next(row for row in library.maneuvers if row.id == number.id)
    left, reached = library.trim(row.from_trim).velocity, library.trim(row.to_trim).velocity
    signed = signed_maneuver_error(row.error, left=left, reached=reached)
    return bool(getattr(row.error, number.name) == getattr(signed, number.name))
