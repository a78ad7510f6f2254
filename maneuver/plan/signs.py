"""`maneuver plan signs`: time and miss of a plan under independent errors."""

import json as json_module
import sys
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.errors import BadFileError, FlightError
from flight.plan.plan import read_plan
from maneuver.options.numbers import Count
from planner.check.plan_check import plan_problems
from planner.independent_errors.error_path import ErrorGranularity
from planner.independent_errors.independent_errors import IndependentErrorBounds, bound_independent_errors
from planner.independent_errors.worst_time import MOST_TIME_BOXES

from .context import check_plan_origin, library_and_mission

WHOLE = 1.0
"""Gamma of plans that have none."""

LOOSE = 1.02
"""Ratio of bound and slowest time found above which the bound is called loose."""

OPTIMISTIC = 1

RESOLUTION = 1e-6
"""Seconds by which a scenario must exceed every single gamma to count as a counter-example."""


def signs(
    file: Path,
    /,
    *,
    library: str | None = None,
    mission: str | None = None,
    each: ErrorGranularity = "primitive",
    boxes: Count = MOST_TIME_BOXES,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Bounds time and miss of a plan under independent errors.

    The table compares the worst case with one gamma for all errors, the worst corner, where the error of each
    trim and maneuver (or of each of their scalars) is -gamma, 0 or +gamma times its bound, and an upper bound
    over all errors between the corners (branch and bound). Times assume coasting times chosen with known
    errors; misses use the plan's coasting times. For a plan without a gamma, gamma is 1. The exit code is 1
    if a corner is slower than the worst single gamma: the plan's cost is then optimistic.

    For example:

        maneuver plan signs plan.json

        maneuver plan signs plan.json --each scalar --boxes 5000

    Args:
        file: plan file of `maneuver plan --out`.
        library: name or path of the library; by default the name in the plan.
        mission: name or path of the mission; by default the mission in the plan, or else its name there.
        each: unit with independent errors: primitive or scalar.
        boxes: largest number of boxes of errors for the bound of the time; more give a tighter bound.
        json: print the result as JSON.
    """
    plan = read_plan(file)
    if not plan.found:
        raise FlightError(f"{file}: expected a plan with a sequence, got status {plan.status}")
    primitives, task = library_and_mission(file, plan, library=library, mission=mission)
    check_plan_origin(file, plan, primitives, task)
    for problem in plan_problems(plan, primitives, task):
        raise BadFileError(file, f"invalid plan: {problem}")
    gamma = plan.gamma or WHOLE
    found = bound_independent_errors(
        primitives,
        task,
        plan.sequence,
        plan.coasting_times,
        gamma=gamma,
        each=each,
        most_boxes=boxes,
    )
    if json:
        figures = {"gamma": gamma, **asdict(found)}
        sys.stdout.write(json_module.dumps(_json_value(figures), indent=2) + "\n")
    else:
        print(f"{plan.mission}, library {plan.library}: independent errors of every {each}, gamma {gamma:g}")
        _print_bounds(found)
    return OPTIMISTIC if found.slowest.value > found.slowest_single.value + RESOLUTION else 0


def _print_bounds(found: IndependentErrorBounds) -> None:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("", "time, s", "miss, m"):
        table.add_column(heading, justify="right" if heading else "left")
    corners = "all" if found.all_tried else "best of local search over"
    rows = {
        "one gamma for all": (found.slowest_single.value, found.furthest_single.value),
        f"{corners} {found.scenarios:,} corners": (found.slowest.value, found.furthest.value),
        "between the corners, found": (found.slowest_bound.found, found.furthest_bound.found),
        "between the corners, upper bound": (found.slowest_bound.bound, found.furthest_bound.bound),
    }
    for name, (seconds, metres) in rows.items():
        unproved = "upper bound" in name and isfinite(found.slowest_bound.found)
        shown = f"{seconds:.4f}" if isfinite(seconds) else "no bound" if unproved else "no arrival"
        table.add_row(name, shown, f"{metres:.3f}")
    console = Console(highlight=False)
    console.print(table)
    for what, extreme in (("slowest", found.slowest), ("furthest", found.furthest)):
        console.print(f"{what} corner: {_describe_errors(found.names, extreme.errors)}", soft_wrap=True)
    worst = found.slowest_bound
    if not isfinite(worst.found):
        lost = _describe_errors(found.names, worst.errors)
        console.print(f"infeasible: with errors {lost} the goal is unreachable", soft_wrap=True)
    elif not isfinite(worst.bound):
        console.print(
            f"no bound of the time after {worst.boxes:,} boxes; raise --boxes: slower cases may exist"
        )
    elif worst.bound > worst.found * LOOSE + RESOLUTION:
        console.print(f"bound of the time after {worst.boxes:,} boxes; raise --boxes to tighten it")


def _describe_errors(names: tuple[str, ...], errors: tuple[float, ...]) -> str:
    """Returns errors in words, as shares of the largest."""
    parts = (
        f"{name} {'-' if error < 0 else '+'}{'' if abs(error) == 1 else f'{abs(error):.3g}'}"
        for name, error in zip(names, errors, strict=True)
        if error
    )
    return ", ".join(parts) or "no errors"


def _json_value(value: Any) -> Any:
    """Returns nested values with what is infinite as None."""
    if isinstance(value, dict):
        return {key: _json_value(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [_json_value(part) for part in value]
    return None if isinstance(value, float) and not isfinite(value) else value
