"""Closed-loop Tables 12 to 26: printed and computed."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

from experiments.mission.policies import PlanningPolicy, planner_of
from planner.closed_loop.automaton_vehicle import AutomatonVehicle
from planner.closed_loop.latency import Latency
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.closed_loop.settings import Settings
from planner.policies.policy import Planner
from scenarios.find import find_library, find_mission

TOLERANCE = {"kinematic": 3.0, "gtmax": 0.9144}
"""Goal tolerances: 3 of the thesis's units of length, which are metres in its kinematic library."""

SETTINGS = Settings(
    activation_interval=1.0,
    max_activations=60,
    tolerance_share=0.1,
    aim=1.0,
    latency=Latency(0.0),
    hysteresis=0.0,
    learn_level=False,
)
"""Loop of section 6.3: every plan is flown at once."""

NOT_REPRODUCED = (
    "Closed loop: the thesis prints neither the replan interval, nor the iteration limit, nor the plant's "
    "errors, so its figures cannot be reproduced, only their pattern. Here: a replan each second, at most "
    f"{SETTINGS.max_activations} replans, all errors of the plant times -gamma or +gamma, goal tolerance "
    "3 units of length, planner tolerance 0.1 of the distance where that is larger; GT-Max missions from "
    "trim 2."
)


@dataclass(frozen=True, slots=True)
class PrintedFlights:
    """Printed flight times of a table, and True where given up."""

    table: int
    mission: str
    gamma: float
    nominal: float
    nominal_gave_up: bool
    worst_case: float
    worst_case_gave_up: bool


PRINTED = (
    PrintedFlights(12, "kinematic-1", 0.0, 19.16843263, False, 19.16731709, False),
    PrintedFlights(13, "kinematic-1", 0.3, 39.8894632, True, 18.96135452, False),
    PrintedFlights(14, "kinematic-1", 0.5, 38.9325863, True, 31.87326767, True),
    PrintedFlights(15, "kinematic-1", 0.8, 61.05847568, True, 19.86228881, False),
    PrintedFlights(16, "kinematic-1", 1.0, 52.62802941, True, 19.36730029, False),
    PrintedFlights(17, "kinematic-2", 0.0, 13.80815399, False, 12.06740119, False),
    PrintedFlights(18, "kinematic-2", 1.0, 68.52195604, True, 17.7543132, False),
    PrintedFlights(19, "gtmax-1", 0.1, 26.75174872, False, 16.0581577, False),
    PrintedFlights(20, "gtmax-1", 0.5, 65.37049147, True, 32.03125826, False),
    PrintedFlights(21, "gtmax-1", 0.7, 52.68776743, True, 24.31112894, False),
    PrintedFlights(22, "gtmax-2", 0.1, 38.77440384, True, 11.98088517, False),
    PrintedFlights(23, "gtmax-2", 0.2, 53.02731146, True, 11.79107632, False),
    PrintedFlights(24, "gtmax-2", 0.3, 51.42835246, True, 22.47452309, False),
    PrintedFlights(25, "gtmax-2", 0.6, 43.98039397, True, 21.0515078, False),
    PrintedFlights(26, "gtmax-2", 0.7, 45.7711984, True, 20.41190763, False),
)


@dataclass(frozen=True, slots=True)
class ClosedLoopComparison:
    """One closed-loop time, printed and computed.

    Attributes:
        table: number of the table.
        mission: name of the shipped mission.
        gamma: gamma of the row.
        policy: policy of the planner.
        printed: printed seconds.
        printed_reached: True if the thesis's flight reached the goal.
        minus: computed seconds with the plant's errors times -gamma; None where given up.
        plus: computed seconds with the plant's errors times +gamma; None where given up.
    """

    table: int
    mission: str
    gamma: float
    policy: str
    printed: float
    printed_reached: bool
    minus: float | None
    plus: float | None


def compare_closed_loops(printed: tuple[PrintedFlights, ...] = PRINTED) -> Iterator[ClosedLoopComparison]:
    """Flies every table with both policies and both signs of errors."""
    for row in printed:
        library = find_library("thesis-kinematic" if row.mission.startswith("kin") else "thesis-gtmax")
        policies: tuple[tuple[PlanningPolicy, float, bool], ...] = (
            ("nominal", row.nominal, row.nominal_gave_up),
            ("worst-case", row.worst_case, row.worst_case_gave_up),
        )
        for policy, seconds, gave_up in policies:
            planner = planner_of(policy, library, gamma=row.gamma)
            minus, plus = (_flight_time(row, planner, sign * row.gamma) for sign in (-1, 1))
            yield ClosedLoopComparison(
                row.table, row.mission, row.gamma, policy, seconds, not gave_up, minus, plus
            )


def count_arrivals(rows: list[ClosedLoopComparison]) -> str:
    """Returns each policy's number of arrivals, printed and computed."""
    counted = []
    for policy in ("nominal", "worst-case"):
        chosen = [row for row in rows if row.policy == policy]
        printed = sum(row.printed_reached for row in chosen)
        ours = sum(time is not None for row in chosen for time in (row.minus, row.plus))
        counted.append(f"{policy}: {printed} of {len(chosen)} printed, {ours} of {2 * len(chosen)} ours")
    return f"Goal reached, {'; '.join(counted)}."


def _flight_time(row: PrintedFlights, planner: Planner, gamma: float) -> float | None:
    """Returns seconds to the goal; None where the flight was given up."""
    kind = row.mission.split("-", maxsplit=1)[0]
    library = find_library(f"thesis-{kind}")
    mission = replace(find_mission(row.mission), tolerance=TOLERANCE[kind])
    vehicle = AutomatonVehicle(library, start=mission.start, trim=mission.start_trim, gamma=gamma)
    flown = fly_closed_loop(vehicle, mission, planner=planner, library=library, settings=SETTINGS)
    return flown.flown_time if flown.reached else None
