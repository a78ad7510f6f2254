"""Printed plan: walk, coasting times, cost of each scenario, guarantees."""

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.automaton.library import Library
from flight.plan.plan import Plan
from planner.check.guarantees import describe_gamma_range, describe_lower_bound


def print_plan(answer: Plan, library: Library) -> None:
    """Prints a plan: walk, coasting times and the cost of each scenario."""
    console = Console(highlight=False)
    if not answer.found:
        console.print(f"{answer.mission}: {answer.status}: {answer.reason}", soft_wrap=True)
        if answer.at_smallest_tolerance is not None:
            wider = answer.at_smallest_tolerance
            console.print(f"smallest feasible tolerance: {wider.tolerance:.4f} m")
            print_plan(wider, library)
        return
    level = "" if answer.policy == "nominal" else f", gamma {answer.gamma:g}"
    console.print(
        f"{answer.mission}, library {answer.library}: {answer.policy}{level}, {answer.cost:.6f} s",
        soft_wrap=True,
    )
    console.print(_walk(answer, library))
    if len(answer.scenarios) > 1:
        console.print(_scenarios(answer))
    bound = f"; no plan {describe_lower_bound(answer)}" if (answer.lower_bound or 0.0) > 0 else ""
    if answer.miss is not None:
        words = f"these coasting times end within {answer.miss:.4f} m of the goal"
        console.print(f"{words} {describe_gamma_range(answer)}", soft_wrap=True)
    verdict = "verified" if answer.verified else "not verified"
    if answer.certificate is not None:
        boxes = sum(len(one.tree.split()) for one in answer.certificate.refutations)
        verdict += f", certified ({len(answer.certificate.refutations)} sequences, {boxes} boxes)"
    console.print(f"{answer.status}, {verdict}{bound}; {1e3 * answer.solve_time:.0f} ms", soft_wrap=True)
    if answer.reason:
        console.print(answer.reason, soft_wrap=True)
    if answer.time_promise is not None:
        console.print(answer.time_promise.sentence, soft_wrap=True)


def _walk(answer: Plan, library: Library) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("trim", "", "coast, s", "maneuver", "to trim"):
        table.add_column(heading, justify="right" if heading == "coast, s" else "left")
    steps = [*(str(maneuver) for maneuver in answer.maneuvers), ""]
    onward = [*(str(trim) for trim in answer.sequence[1:]), ""]
    for trim, time, step, to in zip(answer.sequence, answer.coasting_times, steps, onward, strict=True):
        table.add_row(str(trim), library.trim(trim).name, f"{time:.4f}", step, to)
    return table


def _scenarios(answer: Plan) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("gamma", "cost, s", "", "coasting times, s"):
        left = heading in {"", "coasting times, s"}
        # Where the terminal is narrow, times wrap below times.
        table.add_column(heading, justify="left" if left else "right", no_wrap=heading != "coasting times, s")
    for scenario in answer.scenarios:
        times = "  ".join(f"{time:.4f}" for time in scenario.coasting_times)
        decides = "decides" if scenario is answer.deciding else ""
        table.add_row(f"{scenario.gamma:g}", f"{scenario.cost:.6f}", decides, times)
    return table
