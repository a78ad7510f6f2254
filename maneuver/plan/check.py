"""`maneuver plan check`: validity of a plan, and its proved guarantees."""

import json as json_module
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiments.mission.stated_time_bound import stated_time_bounds, time_bound_problems
from flight.plan.plan import PlanContradictionError, read_plan
from maneuver.options.numbers import Count
from planner.check.guarantees import Guarantees, guarantees_of
from planner.check.plan_check import plan_problems

from .context import library_and_mission

FAILED = 1

NO_GUARANTEES = Guarantees((), ())


def check(
    file: Path,
    /,
    *,
    library: str | None = None,
    mission: str | None = None,
    max_trims: Count | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Checks a plan against its library and mission, without the search.

    A plan file holds its mission and the name and hash of its library, so the other options are only needed
    if that name does not find the library.

    The walk must exist, times must not be negative, every scenario must end at the goal in the stated time,
    and the library must be the one planned with. A committed plan must stay within its tolerance at every
    gamma of its range. A certificate is verified box by box in interval arithmetic: it proves that no plan is
    faster by more than a millisecond, or that there is no plan. Other claims are listed as not proved. A time
    bound is compared with the file beside the library, and with the least time of the closed loop, the only
    part that needs a search. The exit code is 1 if the plan is invalid, or if there is no plan and no
    certificate of that.

    For example:

        maneuver plan check plan.json

        maneuver plan check plan.json --library my-library.json

        maneuver plan check plan.json --library my-library.json --mission my-mission.toml

    Args:
        file: plan file of `maneuver plan --out`.
        library: name or path of the library; by default the name in the plan.
        mission: name or path of the mission; by default the mission in the plan, or else its name there.
        max_trims: number of trims in the longest sequence searched; the mission's by default.
        json: print the result as JSON.
    """
    try:
        answer = read_plan(file)
    except PlanContradictionError as error:
        return _print_verdict(file, (str(error).removeprefix(f"{file}: "),), json=json)
    primitives, task = library_and_mission(
        file, answer, library=library, mission=mission, max_trims=max_trims
    )
    wrong = plan_problems(answer, primitives, task)
    if not answer.found and answer.certificate is None:
        wrong = (
            *wrong,
            f"expected a plan or a certificate, got status {answer.status} without a certificate",
        )
    if not wrong and answer.time_promise is not None:
        wrong = time_bound_problems(
            answer, task, primitives, stated_time_bounds(library or answer.library, primitives)
        )
    return _print_verdict(file, wrong, json=json, said=NO_GUARANTEES if wrong else guarantees_of(answer))


def _print_verdict(
    file: Path, wrong: tuple[str, ...], *, json: bool, said: Guarantees = NO_GUARANTEES
) -> int:
    if json:
        verdict = {"passed": not wrong, "problems": wrong, "proved": said.proved, "unproved": said.unproved}
        sys.stdout.write(json_module.dumps(verdict, indent=2) + "\n")
        return FAILED if wrong else 0
    for problem in wrong:
        print(problem)
    print(f"{file}: {'invalid' if wrong else 'valid'}")
    for heading, sentences in (("proved", said.proved), ("not proved", said.unproved)):
        for sentence in sentences:
            print(f"  {heading + ':':<12}{sentence}")
    return FAILED if wrong else 0
