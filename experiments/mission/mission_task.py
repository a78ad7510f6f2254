"""Specification of one closed-loop flight."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.closed_loop.settings import Settings
from sim.loop.specification import SUPERVISED_OPTIONS, FlightOptions

from .policies import FlownPolicy
from .safe_envelope import DEFAULT_ENVELOPE, SafeEnvelope

Plant = Literal["helicopter", "random", "law"] | float
"""Simulated helicopter; automaton: errors independent per primitive, by joint laws, or at one true gamma."""


@dataclass(frozen=True)
class MissionTask:
    """Complete specification of one closed-loop flight.

    Attributes:
        mission: the mission.
        library: library for planning and flight.
        policy: policy of the planner.
        gamma: gamma of the worst-case planner.
        plant: the plant.
        wind: wind class.
        seed: seed of all random numbers.
        settings: settings of the closed loop.
        max_nodes: the planner's limit of walks solved per level; None for no limit.
        flight_options: options of the helicopter's flight.
        envelope: safe envelope of the helicopter.
        log: path of the flight log; None for no log.
        force: overwrite the log.
    """

    mission: Mission
    library: Library
    policy: FlownPolicy
    gamma: float
    wind: str
    seed: int
    plant: Plant = "helicopter"
    settings: Settings = field(default_factory=Settings)
    max_nodes: int | None = None
    flight_options: FlightOptions = SUPERVISED_OPTIONS
    envelope: SafeEnvelope = DEFAULT_ENVELOPE
    log: Path | None = None
    force: bool = False

    @property
    def stated_mission(self) -> Mission:
        """Mission as stated; the cost of its plan is the planned time."""
        tolerance = self.settings.final_tolerance or self.mission.tolerance
        return replace(self.mission, tolerance=tolerance)
