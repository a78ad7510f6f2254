"""`maneuver plan`: plan of a mission."""

import sys
from math import inf
from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from experiments.mission.no_plan import with_full_reason
from experiments.mission.policies import ALPHA, DEFAULT_POLICY, GAMMA, planner_of
from experiments.mission.stated_time_bound import stated_time_bounds, with_time_bound
from flight.errors import FlightError
from flight.plan.plan import Policy, plan_text, with_mission
from flight.plan.time_bound import time_bounds_path
from maneuver.options.depth import at_depth
from maneuver.options.domain_warnings import warn_of_walk
from maneuver.options.numbers import Count, Seconds
from runtime.atomic_write import check_output_files, write_atomically
from scenarios.find import find_library, find_mission, library_path, mission_path

from .check import check
from .context import holds_no_plan
from .policy_options import check_policy_options
from .prices import png_bytes, print_prices
from .show import print_plan
from .signs import signs

NO_PLAN = 1

app = App(name="plan")
app.command(signs)
app.command(check)


@app.default
def plan(
    mission: str,
    /,
    *,
    library: str = "gtmax-sim",
    policy: Policy | None = None,
    gamma: float | None = None,
    alpha: float | None = None,
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
    """Plans a mission: trims and coasting times of least total time.

    The nominal policy ignores the errors. The worst-case policy plans for errors scaled by -gamma, 0 and
    +gamma and minimises the largest of the three times; the printed coasting times are those of the deciding
    gamma. The price-of-robustness policy finds the largest gamma such that the worst-case time at every
    smaller one stays within alpha times the nominal optimum; --pareto shows the whole curve. The committed
    policy fixes the coasting times before gamma is known: they end within the tolerance at every gamma from
    -gamma to gamma; if that is impossible, the smallest feasible tolerance is printed. Every plan is verified
    by code that is independent of the search. The exit code is 1 if there is no plan; if longer sequences
    have one that is found quickly, the message gives the --max-trims to use.

    For example:

        maneuver plan kinematic-1 --library thesis-kinematic --policy nominal

        maneuver plan kinematic-2 --library thesis-kinematic --gamma 0.5 --picture plan.png

        maneuver plan my-mission.toml --library my-library.json --out plan.json

        maneuver plan gtmax-1 --library thesis-gtmax --certify --out proved.json

        maneuver plan gtmax-1 --library thesis-gtmax --policy committed --gamma 0.1 --horizon 200

        maneuver plan gtmax-1 --policy price-of-robustness --alpha 1.1

        maneuver plan gtmax-1 --pareto --picture price.png

    Args:
        mission: name or path of the mission.
        library: name or path of the library.
        policy: planning policy; worst-case by default.
        gamma: uncertainty level of the worst-case and committed policies, 0 to 1; 1 by default.
        alpha: worst-case time over nominal optimum accepted by the price-of-robustness policy, at least 1;
            1.2 by default.
        pareto: print the price of robustness from gamma 0 to 1 instead of a plan.
        max_nodes: limit of the search: sequences solved at one gamma, or boxes of coasting times of the
            committed policy; at the limit the best plan so far is returned.
        deadline: time limit in seconds, after which the best plan so far is returned with a bound.
        horizon: longest time of a committed plan in seconds; longer plans are not searched; by default 120,
            or twice the nominal plan's time if that is more.
        max_trims: number of trims in the longest sequence; the mission's by default.
        certify: prove optimality within a millisecond, or that there is no plan; the certificate is stored in
            the plan for `maneuver plan check`.
        out: plan file to write, with its mission, as JSON. A file without a plan is replaced even without
            --force.
        picture: picture of the plan to write, as PNG.
        force: overwrite OUT and PICTURE.
        json: print the plan as JSON.
    """
    given = {"--gamma": gamma, "--alpha": alpha, "--certify": certify}
    given |= {"--max-nodes": max_nodes, "--deadline": deadline, "--horizon": horizon}
    check_policy_options(policy, given, pareto=pareto)
    if horizon is not None and gamma == 0:
        raise FlightError("--horizon: expected --gamma above 0, got 0")
    read = [mission_path(mission), library_path(library), time_bounds_path(library_path(library))]
    replace_out = force or holds_no_plan(out)
    check_output_files(out, picture, force=True, inputs=read)
    check_output_files(out, force=replace_out)
    check_output_files(picture, force=force, ending=".png")
    primitives = find_library(library)
    task = at_depth(find_mission(mission, primitives), max_trims)
    if pareto:
        return print_prices(
            primitives, task, out=out, picture=picture, replace_out=replace_out, force=force, json=json
        )
    planner = planner_of(
        policy or DEFAULT_POLICY,
        primitives,
        gamma=GAMMA if gamma is None else gamma,
        alpha=ALPHA if alpha is None else alpha,
        max_nodes=max_nodes,
        deadline=inf if deadline is None else deadline,
        horizon=horizon,
    )
    answer = planner.plan(task)
    if certify:
        from planner.proof.certify_plan import certify_plan

        answer = certify_plan(answer, primitives, task)
    answer = with_full_reason(answer, primitives, task)
    answer = with_time_bound(answer, task, planner, primitives, stated_time_bounds(library, primitives))
    if answer.found:
        warn_of_walk(primitives, answer.sequence, answer.coasting_times)
    text = plan_text(with_mission(answer, task))
    if out is not None:
        write_atomically(text.encode(), out, force=replace_out)
    if picture is not None and answer.found:
        from review.pictures.plan_picture import plan_picture

        write_atomically(png_bytes(plan_picture(answer, primitives, task)), picture, force=force)
    if json:
        sys.stdout.write(text)
    else:
        print_plan(answer, primitives)
    return 0 if answer.found else NO_PLAN
