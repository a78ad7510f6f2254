"""Tables 12 to 26 in open and closed loop: printed and computed."""

import csv
import io
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, fields, replace

from experiments.mission.fly import fly_mission
from experiments.mission.mission_task import MissionTask
from experiments.mission.policies import PlanningPolicy, planner_of
from experiments.mission.result import MissionResult
from experiments.validation.scorecard_files import format_number
from planner.closed_loop.latency import Latency
from planner.closed_loop.settings import Settings
from runtime.progress import show_progress
from scenarios.find import find_library, find_mission

TOLERANCE = 0.9144
"""Goal tolerance, m: the thesis's 3 ft; the units of its kinematic missions are unclear."""

LOOPS = {
    "thesis": Settings(
        activation_interval=1.0,
        max_activations=60,
        final_tolerance=TOLERANCE,
        tolerance_share=0.1,
        aim=1.0,
        latency=Latency(0.0),
        hysteresis=0.0,
        learn_level=False,
    ),
    "ours": Settings(max_activations=120, final_tolerance=TOLERANCE),
}
"""Settings of the loop of section 6.3, and of ours, for at least a minute.

The thesis prints neither the replan interval nor the limit: one second and one minute are assumed."""


@dataclass(frozen=True, slots=True)
class PrintedLoop:
    """One printed line: seconds of plan and flight; True where given up."""

    table: int
    mission: str
    gamma: float
    policy: PlanningPolicy
    plan: float
    flight: float
    gave_up: bool


# Table, mission, gamma; nominal plan, flight, given up; worst-case plan, flight, given up.
_PRINTED = (
    (12, "kinematic-1", 0.0, 19.86835686, 19.16843263, False, 19.86835686, 19.16731709, False),
    (13, "kinematic-1", 0.3, 19.86835686, 39.8894632, True, 21.07064123, 18.96135452, False),
    (14, "kinematic-1", 0.5, 19.86835686, 38.9325863, True, 21.93479312, 31.87326767, True),
    (15, "kinematic-1", 0.8, 19.86835686, 61.05847568, True, 23.34280767, 19.86228881, False),
    (16, "kinematic-1", 1.0, 19.86835686, 52.62802941, True, 24.3691834, 19.36730029, False),
    (17, "kinematic-2", 0.0, 13.80815399, 13.80815399, False, 13.80815399, 12.06740119, False),
    (18, "kinematic-2", 1.0, 13.80815399, 68.52195604, True, 20.31279186, 17.7543132, False),
    (19, "gtmax-1", 0.1, 17.19564465, 26.75174872, False, 17.5822342, 16.0581577, False),
    (20, "gtmax-1", 0.5, 17.19564465, 65.37049147, True, 19.12782333, 32.03125826, False),
    (21, "gtmax-1", 0.7, 17.19564465, 52.68776743, True, 60.51056468, 24.31112894, False),
    (22, "gtmax-2", 0.1, 13.07107247, 38.77440384, True, 13.42410657, 11.98088517, False),
    (23, "gtmax-2", 0.2, 13.07107247, 53.02731146, True, 13.77880971, 11.79107632, False),
    (24, "gtmax-2", 0.3, 13.07107247, 51.42835246, True, 14.1347008, 22.47452309, False),
    (25, "gtmax-2", 0.6, 13.07107247, 43.98039397, True, 15.20568435, 21.0515078, False),
    (26, "gtmax-2", 0.7, 13.07107247, 45.7711984, True, 15.56276175, 20.41190763, False),
)


def printed_loops() -> Iterator[PrintedLoop]:
    """Yields the tables' lines, nominal before worst case."""
    for table, mission, gamma, plan, flight, gave_up, robust_plan, robust_flight, robust_gave_up in _PRINTED:
        yield PrintedLoop(table, mission, gamma, "nominal", plan, flight, gave_up)
        yield PrintedLoop(table, mission, gamma, "worst-case", robust_plan, robust_flight, robust_gave_up)


@dataclass(frozen=True, slots=True)
class LoopComparison:
    """A table's line, printed and computed with the thesis's library.

    Attributes:
        table: number of the table.
        mission: name of the shipped mission.
        gamma: gamma of plan and plant.
        policy: policy of the planner.
        printed_plan: printed seconds of the plan.
        plan: computed seconds of the plan that meets the goal exactly; None without a plan.
        printed_flight: printed seconds of the flight.
        printed_gave_up: True if it ended at the limit of replans.
        thesis_loop_minus: computed seconds in the thesis's loop, plant at -gamma; None where given up.
        thesis_loop_plus: the same at +gamma.
        our_loop_minus: the same in our loop at -gamma.
        our_loop_plus: the same in our loop at +gamma.
    """

    table: int
    mission: str
    gamma: float
    policy: str
    printed_plan: float
    plan: float | None
    printed_flight: float
    printed_gave_up: bool
    thesis_loop_minus: float | None
    thesis_loop_plus: float | None
    our_loop_minus: float | None
    our_loop_plus: float | None


def compare_loops(executor: Executor) -> list[LoopComparison]:
    """Compares every line of Tables 12 to 26 at both gammas."""
    lines = list(printed_loops())
    tasks = [task for line in lines for task in _tasks(line)]
    flown = list(
        show_progress(executor.map(fly_mission, tasks), total=len(tasks), what="flying Tables 12 to 26")
    )
    return [_compare(line, flown[4 * place : 4 * place + 4]) for place, line in enumerate(lines)]


def _tasks(line: PrintedLoop) -> list[MissionTask]:
    library = find_library(_library(line.mission))
    mission = find_mission(line.mission)
    return [
        MissionTask(
            mission=mission,
            library=library,
            policy=line.policy,
            gamma=line.gamma,
            wind="none",
            seed=0,
            plant=sign * line.gamma,
            settings=settings,
        )
        for settings in LOOPS.values()
        for sign in (-1.0, 1.0)
    ]


def _compare(line: PrintedLoop, flown: Sequence[MissionResult]) -> LoopComparison:
    mission = replace(find_mission(line.mission), tolerance=0.0)
    plan = planner_of(line.policy, find_library(_library(line.mission)), gamma=line.gamma).plan(mission)
    times = [row.flown_time if row.reached else None for row in flown]
    return LoopComparison(
        table=line.table,
        mission=line.mission,
        gamma=line.gamma,
        policy=line.policy,
        printed_plan=line.plan,
        plan=plan.cost if plan.found else None,
        printed_flight=line.flight,
        printed_gave_up=line.gave_up,
        thesis_loop_minus=times[0],
        thesis_loop_plus=times[1],
        our_loop_minus=times[2],
        our_loop_plus=times[3],
    )


def _library(mission: str) -> str:
    return "thesis-kinematic" if mission.startswith("kinematic") else "thesis-gtmax"


def count_arrivals_by_policy(rows: Iterable[LoopComparison]) -> dict[str, tuple[int, int, int]]:
    """Returns arrivals by policy: printed, thesis's loop, our loop."""
    found = {}
    known = list(rows)
    for policy in ("nominal", "worst-case"):
        own = [row for row in known if row.policy == policy]
        found[policy] = (
            sum(not row.printed_gave_up for row in own),
            sum(None not in {row.thesis_loop_minus, row.thesis_loop_plus} for row in own),
            sum(None not in {row.our_loop_minus, row.our_loop_plus} for row in own),
        )
    return found


def loops_csv(rows: Sequence[LoopComparison]) -> str:
    """Returns the lines as CSV; empty fields for given-up flights."""
    stream = io.StringIO()
    writer = csv.DictWriter(stream, [field.name for field in fields(LoopComparison)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(asdict(row) for row in rows)
    return stream.getvalue()


HEADS = (
    *("table", "mission", "gamma", "policy", "plan, printed", "ours", "flight, printed"),
    *("thesis's loop, -gamma", "+gamma", "our loop, -gamma", "+gamma"),
)


def loops_markdown(rows: Sequence[LoopComparison]) -> str:
    """Returns the lines as a Markdown table."""
    lines = ["| " + " | ".join(HEADS) + " |", "| " + " | ".join(["---"] * len(HEADS)) + " |"]
    for row in rows:
        flight = (
            f"gave up at {row.printed_flight:.2f}" if row.printed_gave_up else f"{row.printed_flight:.2f}"
        )
        cells = [str(row.table), row.mission, f"{row.gamma:g}", row.policy, f"{row.printed_plan:.3f}"]
        cells += [format_number(row.plan, 3), flight]
        cells += [_time(time) for time in (row.thesis_loop_minus, row.thesis_loop_plus)]
        cells += [_time(time) for time in (row.our_loop_minus, row.our_loop_plus)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _time(time: float | None) -> str:
    return "not reached" if time is None else f"{time:.2f}"
