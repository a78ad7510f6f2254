"""`maneuver plan signs`: how far a plan's single gamma can be trusted."""

import json as json_module
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.errors import FlightError
from flight.plan import read_plan
from planner.signs import all_signs

from .files import find_library, find_mission

TOO_HOPEFUL = 1

RESOLUTION = 1e-6
"""Seconds by which a scenario must exceed every single gamma to count as a counter-example."""


def signs(
    file: Path,
    /,
    *,
    library: str | None = None,
    mission: str | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Tries every primitive of a plan with a sign of its own: which scenario is slowest, which ends furthest.

    Each trim and maneuver takes its errors -gamma, 0 or +gamma times. The slowest scenario has coasting times
    of its own, the furthest flies those of the plan. These are corners, no bound on what lies between. The
    exit code is 1 where a scenario is slower than every single gamma: the plan's cost is too hopeful.

    For example:

        maneuver plan signs plan.json

    Args:
        file: the plan, as `maneuver plan --out` writes it.
        library: name or path; by default the name that the plan gives.
        mission: name or path; by default the name that the plan gives.
        json: print the scenarios as JSON.
    """
    plan = read_plan(file)
    if not plan.found:
        raise FlightError(f"expected a plan with a sequence, {file} is {plan.status}")
    primitives, task = find_library(library or plan.library), find_mission(mission or plan.mission)
    tried = all_signs(primitives, task, plan.sequence, plan.coasting_times, gamma=plan.gamma or 1.0)
    rows = {
        "slowest": tried.slowest,
        "slowest with one sign for all": tried.slowest_single,
        "furthest from the goal": tried.furthest,
        "furthest with one sign for all": tried.furthest_single,
    }
    if json:
        document = {"scenarios": len(tried.scenarios)} | {name: asdict(row) for name, row in rows.items()}
        text = json_module.dumps(document, indent=2).replace("Infinity", "null")
        sys.stdout.write(text + "\n")
    else:
        table = Table(box=SIMPLE_HEAD, pad_edge=False)
        for heading in (f"of {len(tried.scenarios)} scenarios", "signs", "time, s", "miss, m"):
            table.add_column(heading, justify="right" if "," in heading else "left")
        for name, row in rows.items():
            drawn = " ".join("-0+"[sign + 1] for sign in row.signs)
            table.add_row(name, drawn, f"{row.cost:.4f}", f"{row.miss:.3f}")
        Console(highlight=False).print(table)
    return TOO_HOPEFUL if tried.slowest.cost > tried.slowest_single.cost + RESOLUTION else 0
