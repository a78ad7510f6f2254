"""`maneuver plan`: a mission in, a plan out; `maneuver plan check`: whether a plan keeps its word."""

import json as json_module
import sys
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.errors import FlightError
from flight.library import Library
from flight.log_file import publish_bytes
from flight.mission import Mission
from flight.plan import Plan, PlanContradictionError, plan_text, read_plan
from planner.check import problems
from planner.nominal import Nominal
from planner.policy import Planner
from planner.price_of_robustness import PriceOfRobustness
from planner.worst_case import WorstCase

from .domain import warn_of_walk
from .files import find_library, find_mission, refuse_existing
from .numbers import Count, Seconds
from .policies import PlannedPolicy
from .prices import png, show_prices
from .promised import promised_times, with_promise
from .signs import signs

NO_PLAN = 1
KEPT = "keeps its word"

# More trims than that are more walks than can be searched in minutes.
MOST_TRIMS = 8

app = App(name="plan")
app.command(signs)


@app.default
def plan(
    mission: str,
    /,
    *,
    library: str = "gtmax-sim",
    policy: PlannedPolicy = "worst-case",
    gamma: float = 1.0,
    alpha: float = 1.2,
    pareto: Annotated[bool, Parameter(negative="")] = False,
    max_nodes: Count | None = None,
    deadline: Seconds | None = None,
    horizon: Seconds | None = None,
    max_trims: Count | None = None,
    certify: Annotated[bool, Parameter(negative="")] = False,
    out: Path | None = None,
    picture: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Plans a mission: the trims, and how long to hold each, so that the goal is reached in the least time.

    The nominal policy believes the library. The worst-case policy plans for its errors, scaled by 0, -gamma
    and +gamma at once, and takes the sequence whose worst case is best; the coasting times shown are those of
    the deciding gamma. The price-of-robustness policy takes the largest gamma whose worst-case time stays, at
    it and at every smaller one, within alpha times the nominal optimum; --pareto shows the whole curve.
    The committed policy fixes the coasting times before gamma is known: they end within the tolerance at
    every gamma from -gamma to gamma, and where none do, the smallest tolerance for which some do is shown.
    Every plan is flown again by code that shares nothing with the search. The exit code is 1 where there is
    no plan.

    For example:

        maneuver plan kinematic-1 --library thesis-kinematic --policy nominal

        maneuver plan kinematic-2 --library thesis-kinematic --gamma 0.5 --picture plan.png

        maneuver plan my-mission.toml --library my-library.json --out plan.json

        maneuver plan gtmax-1 --library thesis-gtmax --certify --out proved.json

        maneuver plan gtmax-1 --library thesis-gtmax --policy committed --gamma 0.1 --horizon 200

        maneuver plan gtmax-1 --policy price-of-robustness --alpha 1.1

        maneuver plan gtmax-1 --pareto --picture price.png

    Args:
        mission: name or path.
        library: name or path.
        policy: which planner.
        gamma: uncertainty level of the worst-case and the committed planner, 0 to 1.
        alpha: worst-case time that the price-of-robustness planner accepts, in nominal optima, at least 1.
        pareto: show the price of robustness, from gamma 0 to 1, instead of a plan.
        max_nodes: sequences at one gamma that may be solved, or boxes of coasting times that the committed
            planner may examine, before the best plan so far is given.
        deadline: seconds after which the best plan so far is given, with a bound.
        horizon: seconds that a committed plan may take, and beyond which nothing is claimed where there is
            none; by default 120, or twice the nominal plan's where that is more.
        max_trims: longest sequence; the mission's by default.
        certify: prove that no plan is faster by more than a millisecond, or that there is none, and leave
            the proof in the plan for `maneuver plan check`.
        out: file for the plan, as JSON.
        picture: file for a picture of the plan, as PNG.
        force: overwrite these files.
        json: print the plan as JSON.
    """
    for path in (out, picture):
        if path is not None:
            refuse_existing(path, force=force)
    if horizon is not None and (pareto or policy != "committed" or gamma == 0):
        asked = "--pareto" if pareto else f"{policy} at gamma {gamma:g}"
        raise FlightError(f"expected --horizon with --policy committed and a gamma above 0, got {asked}")
    primitives, task = find_library(library), _asked(mission, max_trims)
    if pareto:
        return show_prices(primitives, task, out=out, picture=picture, force=force, json=json)
    if certify and policy == "committed":
        raise FlightError("expected a policy that can be certified; committed plans carry no certificate")
    limit = inf if deadline is None else deadline
    planner = _planner(primitives, policy, gamma, alpha, max_nodes=max_nodes, deadline=limit, horizon=horizon)
    answer = planner.plan(task)
    if certify:
        from planner.certified import certified

        answer = certified(answer, primitives, task)
    answer = with_promise(answer, task, planner, primitives, promised_times(library, primitives))
    if answer.found:
        warn_of_walk(primitives, answer.sequence, answer.coasting_times)
    if out is not None:
        publish_bytes(plan_text(answer).encode(), out, force=force)
    if picture is not None and answer.found:
        from review.plan_picture import plan_picture

        publish_bytes(png(plan_picture(answer, primitives, task)), picture, force=force)
    if json:
        sys.stdout.write(plan_text(answer))
    else:
        show(answer, primitives)
    return 0 if answer.found else NO_PLAN


@app.command
def check(
    file: Path,
    /,
    *,
    library: str | None = None,
    mission: str | None = None,
    max_trims: Count | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Checks a plan against its library and mission, without the search and without the solver.

    The walk must exist, no time be negative, every scenario end at the goal and take the time it says, and
    the library be the one planned with. A committed plan must stay within its tolerance at every gamma, not
    only at those shown. A certificate is verified box by box in interval arithmetic: then no
    plan is faster by more than a millisecond, or there is none. The exit code is 1 where the plan fails, or
    where there is none and no certificate that proves it.

    For example:

        maneuver plan check plan.json

        maneuver plan check plan.json --library my-library.json --mission my-mission.toml

    Args:
        file: the plan, as `maneuver plan --out` writes it.
        library: name or path; by default the name that the plan gives.
        mission: name or path; by default the name that the plan gives.
        max_trims: longest sequence that was asked for; the mission's by default.
        json: print the verdict as JSON.
    """
    try:
        answer = read_plan(file)
    except PlanContradictionError as error:
        return _verdict(file, (str(error).removeprefix(f"{file}: "),), json=json)
    task = find_mission(mission or answer.mission)
    # A search may have been asked for longer sequences than the mission's file says.
    wider = answer.at_smallest_tolerance or answer
    task = replace(
        task, max_trims=max_trims or max(task.max_trims, len(answer.sequence), len(wider.sequence))
    )
    primitives = find_library(library or answer.library)
    wrong = problems(answer, primitives, task)
    if not answer.found and answer.certificate is None:
        wrong = (*wrong, f"it holds no plan, only the word that there is none ({answer.status})")
    unproved = answer.status == "optimal" and answer.certificate is None and answer.policy != "committed"
    words = f"{KEPT}; that no plan is faster is not proved (no certificate)" if unproved else KEPT
    return _verdict(file, wrong, json=json, words=words)


def _verdict(file: Path, wrong: tuple[str, ...], *, json: bool, words: str = KEPT) -> int:
    if json:
        sys.stdout.write(json_module.dumps({"passed": not wrong, "problems": wrong}, indent=2) + "\n")
    else:
        for problem in wrong:
            print(problem)
        print(f"{file}: {'fails its check' if wrong else words}")
    return NO_PLAN if wrong else 0


def show(answer: Plan, library: Library) -> None:
    """Prints a plan for people: the walk with its times, and every scenario's cost."""
    console = Console(highlight=False)
    if not answer.found:
        console.print(f"{answer.mission}: {answer.status}: {answer.reason}", soft_wrap=True)
        if answer.at_smallest_tolerance is not None:
            wider = answer.at_smallest_tolerance
            console.print(f"the smallest tolerance for which there is a plan: {wider.tolerance:.4f} m")
            show(wider, library)
        return
    level = "" if answer.policy == "nominal" else f", gamma {answer.gamma:g}"
    console.print(f"{answer.mission} on {answer.library}: {answer.policy}{level}, {answer.cost:.6f} s")
    console.print(_walk(answer, library))
    if len(answer.scenarios) > 1:
        console.print(_scenarios(answer))
    bound = "" if answer.lower_bound is None else f"; no plan takes less than {answer.lower_bound:.3f} s"
    if answer.miss is not None:
        words = f"the same times end within {answer.miss:.4f} m of the goal at every gamma"
        console.print(f"{words} from {-answer.gamma:g} to {answer.gamma:g}", soft_wrap=True)
    verdict = "verified" if answer.verified else "not verified"
    if answer.certificate is not None:
        boxes = sum(len(one.tree.split()) for one in answer.certificate.refutations)
        verdict += f", certified ({len(answer.certificate.refutations)} sequences, {boxes} boxes)"
    console.print(f"{answer.status}, {verdict}{bound}; {1e3 * answer.solve_time:.0f} ms", soft_wrap=True)
    if answer.reason:
        console.print(answer.reason, soft_wrap=True)
    if answer.time_promise is not None:
        console.print(answer.time_promise.sentence, soft_wrap=True)


def _planner(
    library: Library,
    policy: PlannedPolicy,
    gamma: float,
    alpha: float,
    *,
    max_nodes: int | None,
    deadline: float,
    horizon: float | None,
) -> Planner:
    if policy == "nominal":
        return Nominal(library, max_nodes=max_nodes, deadline=deadline)
    if policy == "price-of-robustness":
        return PriceOfRobustness(library, alpha)
    if policy == "committed":
        from planner.committed import Committed

        return Committed(library, gamma, max_nodes=max_nodes, deadline=deadline, horizon=horizon)
    return WorstCase(library, gamma, max_nodes=max_nodes, deadline=deadline)


def _walk(answer: Plan, library: Library) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("hold trim", "", "for, s", "then maneuver", "to trim"):
        table.add_column(heading, justify="right" if heading == "for, s" else "left")
    steps = [*(str(maneuver) for maneuver in answer.maneuvers), ""]
    onward = [*(str(trim) for trim in answer.sequence[1:]), ""]
    for trim, time, step, to in zip(answer.sequence, answer.coasting_times, steps, onward, strict=True):
        table.add_row(str(trim), library.trim(trim).name, f"{time:.4f}", step, to)
    return table


def _scenarios(answer: Plan) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("gamma", "cost, s", "coasting times, s"):
        table.add_column(heading, justify="left" if heading.startswith("coasting") else "right")
    for scenario in answer.scenarios:
        times = "  ".join(f"{time:.4f}" for time in scenario.coasting_times)
        decides = "  decides" if scenario is answer.deciding else ""
        table.add_row(f"{scenario.gamma:g}", f"{scenario.cost:.6f}", times + decides)
    return table


def _asked(name: str, max_trims: int | None) -> Mission:
    task = find_mission(name)
    if max_trims is not None:
        task = replace(task, max_trims=max_trims)
    if task.max_trims > MOST_TRIMS:
        raise FlightError(f"expected at most {MOST_TRIMS} trims in a sequence, got {task.max_trims}")
    return task
