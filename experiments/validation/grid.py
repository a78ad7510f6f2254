"""Grid of a validation: missions, policies, gammas, plants, winds, seeds."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from experiments.mission.fly import mission_seed
from experiments.mission.mission_task import MissionTask, Plant
from experiments.mission.policies import FlownPolicy
from experiments.mission.sensor_tolerance import check_tolerance
from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from planner.closed_loop.settings import Settings
from sim.loop.specification import SUPERVISED_OPTIONS, FlightOptions


@dataclass(frozen=True, slots=True)
class Grid:
    """Combinations of missions, policies, gammas, plants and winds to fly."""

    missions: tuple[Mission, ...]
    policies: Sequence[FlownPolicy]
    library: Library
    gammas: Sequence[float]
    true_gammas: Sequence[str]
    winds: Sequence[str]
    flights: int
    seed: int
    settings: Settings
    max_nodes: int | None
    logs: Path | None
    flight_options: FlightOptions = SUPERVISED_OPTIONS

    def tasks(self) -> list[MissionTask]:
        """Returns every distinct flight; policies share the wind of a mission.

        Raises:
            ToleranceTooFineError: the sensors cannot tell the goal of a mission.
        """
        tasks = [
            self._task(mission, policy, gamma, plant=plant, wind=wind, number=number)
            for mission in self.missions
            for policy in self.policies
            for gamma in self.gammas
            for plant, wind in self._plants(gamma)
            for number in range(self.flights)
        ]
        for task in tasks:
            check_tolerance(task)
        return list({self._identity(task): task for task in tasks}.values())

    def _task(
        self, mission: Mission, policy: FlownPolicy, gamma: float, *, plant: Plant, wind: str, number: int
    ) -> MissionTask:
        level = 0.0 if policy == "nominal" else gamma
        name = f"{mission.name}-{policy}-{level:g}-{wind}-{number:04d}.mcap"
        return MissionTask(
            mission=mission,
            library=self.library,
            policy=policy,
            gamma=level,
            plant=plant,
            wind=wind,
            seed=mission_seed(self.seed, mission.name, number),
            settings=self.settings,
            max_nodes=self.max_nodes,
            flight_options=self.flight_options,
            log=None if self.logs is None else self.logs / name,
            force=True,
        )

    def _plants(self, gamma: float) -> list[tuple[Plant, str]]:
        if not self.true_gammas:
            return [("helicopter", wind) for wind in self.winds]
        plants = [_true_plant(word, gamma) for word in self.true_gammas]
        if self.flights != 1 and any(isinstance(plant, float) for plant in plants):
            raise FlightError(
                "--plant automaton without --true-gamma random repeats a flight exactly: expected "
                f"--flights 1, got {self.flights}"
            )
        return [(plant, "none") for plant in plants]

    def _identity(self, task: MissionTask) -> tuple[object, ...]:
        return task.mission.name, task.policy, task.gamma, task.plant, task.wind, task.seed


def _true_plant(word: str, gamma: float) -> Plant:
    match word:
        case "random":
            return "random"
        case "plus":
            return gamma
        case "minus":
            return -gamma
    try:
        return float(word)
    except ValueError:
        raise FlightError(
            f"--true-gamma: expected levels from -1 to 1, `plus`, `minus` or `random`, got {word!r}"
        ) from None
