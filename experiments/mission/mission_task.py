"""One closed-loop flight as it is asked for."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.closed_loop.settings import Settings
from sim.loop.specification import SUPERVISED_OPTIONS, FlightOptions

from .policies import FlownPolicy
from .safe_envelope import DEFAULT_ENVELOPE, SafeEnvelope

Plant = Literal["helicopter", "random"] | float
"""What flies: the simulated helicopter; the automaton, its primitives with errors that know nothing of one
another; or the automaton at one true gamma."""


@dataclass(frozen=True)
class MissionTask:
    """One closed-loop flight, completely.

    Attributes:
        mission: what is to be reached.
        library: planned with, and flown with.
        policy: which planner.
        gamma: uncertainty level of the worst-case planner.
        plant: what flies.
        wind: wind class.
        seed: of all chance.
        settings: how the loop is closed.
        max_nodes: the planner's deadline, in walks that it may solve at one level; None for all it needs.
        flight_options: of the helicopter's flight from the plain one.
        envelope: in which the helicopter counts as safe.
        log: where the flight log goes; None keeps none.
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
