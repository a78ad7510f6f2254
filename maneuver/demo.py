"""`maneuver demo`: small example of all steps."""

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from experiments.campaign.evidence import gather_evidence
from experiments.campaign.fly_campaign import CampaignOrder, fly_campaign
from experiments.mission.fly import fly_mission, mission_seed
from experiments.mission.mission_task import MissionTask
from experiments.mission.policies import COMPARED_POLICIES, planner_of
from experiments.mission.result import MissionResult
from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flightlog.file.reader import read_log
from identification.data_sheet import describe_sample_size
from identification.identify import identify
from maneuver.library.library_files import write_library_files
from maneuver.options.numbers import Count, Seed
from maneuver.options.population import campaign_population
from review.pictures.demo_picture import FlownPlan, demo_picture
from review.pictures.flight_picture import write_picture, write_pictures
from review.pictures.library_picture import library_picture
from runtime.atomic_write import check_output_folder
from runtime.executor import JobExecutor, default_workers, worker_pool
from runtime.progress import show_progress
from scenarios.find import find_campaign, find_mission
from sim.loop.specification import FlightOptions

CAMPAIGN = "gtmax"
MISSION = "gtmax-2"
GAMMA = 1.0


def demo(
    *,
    out: Path = Path("demo"),
    flights: Count = 12,
    repeats: Count = 4,
    seed: Seed = 1,
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies, identifies, plans, flies the plans and reviews, in about a minute.

    A library is identified from a few flights in turbulence. Both policies plan a mission of the thesis with
    it. Each plan is flown in the same turbulence, with replanning. The last lines list the pictures.

    For example:

        maneuver demo

        maneuver demo --flights 30 --out more

    Args:
        out: folder for all results.
        flights: number of identification flights.
        repeats: number of flights of each plan.
        seed: seed of all random numbers.
        workers: number of processes; one per processor by default.
        force: write into a folder that is not empty.
    """
    check_output_folder(out, force=force)
    console = Console(highlight=False)
    mission = find_mission(MISSION)
    with worker_pool(workers or default_workers()) as executor:
        stages = _Demo(out, seed, force, executor)
        with _report_step(console, f"fly       {flights} flights of campaign {CAMPAIGN}, in its wind"):
            logs = stages.fly(flights)
        with _report_step(console, "identify  a library with uncertainties from their logs"):
            library = stages.identify(logs)
        with _report_step(console, f"plan      mission {MISSION}, nominal and worst-case"):
            plans = [planner_of(policy, library, gamma=GAMMA).plan(mission) for policy in COMPARED_POLICIES]
        with _report_step(console, f"fly       each plan {repeats} times, with replanning"):
            results = stages.fly_plans(mission, library, repeats)
        with _report_step(console, "review    the flights as pictures"):
            pictures = stages.review(mission, library, plans, results)
    console.print(f"library     {describe_sample_size(library)}", soft_wrap=True)
    for plan in plans:
        console.print(
            _describe_outcome(plan, [row for row in results if row.policy == plan.policy]), soft_wrap=True
        )
    for path, meaning in pictures.items():
        console.print(f"{path}  {meaning}", soft_wrap=True)
    return 0


def _describe_outcome(plan: Plan, flights: list[MissionResult]) -> str:
    """Returns planned and flown times of a policy."""
    planned = f"planned {plan.cost:.1f} s" if plan.found else f"no plan: {plan.reason}"
    times = sorted(flight.flown_time for flight in flights if flight.reached)
    flown = f" in {times[0]:.1f} to {times[-1]:.1f} s" if times else ""
    return f"{plan.policy:<11} {planned}; goal reached in {len(times)} of {len(flights)} flights{flown}"


@contextmanager
def _report_step(console: Console, what: str) -> Iterator[None]:
    began = perf_counter()
    yield
    console.print(f"{what:<62} {perf_counter() - began:5.1f} s", soft_wrap=True)


@dataclass(frozen=True, slots=True)
class _Demo:
    """Stages of the demo with their shared settings."""

    out: Path
    seed: int
    force: bool
    executor: Executor

    def fly(self, flights: int) -> list[Path]:
        campaign = find_campaign(CAMPAIGN)
        population = campaign_population(campaign, None, airframe=None, seed=self.seed, sensors=None)
        order = CampaignOrder(
            campaign,
            seed=self.seed,
            flights=flights,
            wind=campaign.wind,
            flight_options=FlightOptions(**population),
        )
        job_executor = JobExecutor(self.executor)
        flown = fly_campaign(order, self.out / "flights", job_executor=job_executor, force=self.force)
        return [flight.path for flight in flown.flights]

    def identify(self, logs: list[Path]) -> Library:
        library = identify(gather_evidence(logs, executor=self.executor), name="demo")
        write_library_files(library, self.out / "demo.json", force=self.force)
        return library

    def fly_plans(self, mission: Mission, library: Library, repeats: int) -> list[MissionResult]:
        tasks = [
            MissionTask(
                mission=mission,
                library=library,
                policy=policy,
                gamma=GAMMA,
                wind=library.conditions.wind,
                seed=mission_seed(self.seed, mission.name, number),
                log=self.out / "missions" / f"{policy}-{number}.mcap",
                force=self.force,
            )
            for policy in COMPARED_POLICIES
            for number in range(repeats)
        ]
        return list(
            show_progress(self.executor.map(fly_mission, tasks), total=len(tasks), what="flying plans")
        )

    def review(
        self, mission: Mission, library: Library, plans: list[Plan], results: list[MissionResult]
    ) -> dict[Path, str]:
        """Draws the pictures and returns their paths with captions."""
        outcomes = []
        for plan in plans:
            paths = [row.log for row in results if row.policy == plan.policy and row.log is not None]
            outcomes.append(FlownPlan(plan, tuple(read_log(path) for path in paths)))
        whole, primitives, folder = self.out / "demo.png", self.out / "library.png", self.out / "flight"
        write_picture(demo_picture(library, mission, outcomes), whole, force=self.force)
        write_picture(library_picture(library), primitives, force=self.force)
        write_pictures(outcomes[-1].flights[0], folder, force=self.force)
        return {
            whole: "library, plans and flights",
            primitives: "identified library",
            folder / "flight.png": "one flight: command, estimate and truth",
        }
