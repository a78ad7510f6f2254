"""Stored result of a closed-loop flight."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from flight.automaton.vehicle import Leg
from flightlog.alarm import ADVICE, Alarm
from planner.closed_loop.remaining_plan import PlanStep

from .error_attribution import Performance
from .policies import FlownPolicy
from .safe_envelope import EnvelopeExit

TRACK_STEP = 0.2
"""Spacing of a stored track's points, seconds."""


@dataclass(frozen=True, slots=True)
class FlownLeg:
    """One primitive of a closed-loop flight, for pictures.

    Attributes:
        trim: id of the trim at its start.
        to_trim: id of a maneuver's target trim; None for a coast.
        start: seconds since the flight's start.
        duration: seconds.
        track: north and east in metres, to the millimetre, along the true track.
    """

    trim: int
    to_trim: int | None
    start: float
    duration: float
    track: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class MissionResult:
    """Result of a closed-loop flight: its `FlightRecord` without plans.

    Attributes:
        planned_time: seconds of the plan for the mission as stated; None without one.
        predicted_time: seconds to the goal predicted by the loop at its start, with latency and aim; None
            without a plan.
        planning_times: CPU seconds of each replan; they differ between repetitions.
        performances: deviations of the helicopter's primitives.
        legs: primitives flown.
        alarms: alarms of the helicopter.
        left: first exit from the safe envelope; None where there was none.
        effects: largest effect of each fault, in the given order; 0 without effect.
        left_tube: scale of the library's errors, and time in seconds at which the helicopter left their tube;
            None where it did not.
    """

    mission: str
    policy: FlownPolicy
    gamma: float
    plant: str
    wind: str
    seed: int
    reached: bool
    claimed: bool
    flown_time: float
    planned_time: float | None
    predicted_time: float | None
    closest: float | None
    replans: int
    failures: int
    safe_stops: int
    reason: str
    log: Path | None
    planning_times: tuple[float, ...] = ()
    performances: tuple[Performance, ...] = ()
    legs: tuple[FlownLeg, ...] = ()
    alarms: tuple[Alarm, ...] = ()
    left: EnvelopeExit | None = None
    effects: tuple[float, ...] = ()
    left_tube: tuple[tuple[float, float | None], ...] = ()

    @property
    def serious_alarms(self) -> tuple[Alarm, ...]:
        """Alarms that end a mission."""
        return tuple(alarm for alarm in self.alarms if alarm.kind not in ADVICE)


def flown_walk(legs: Sequence[FlownLeg]) -> tuple[list[int], list[float]]:
    """Returns a flight's trims and their coasting times; needs a leg."""
    trims, held = [legs[0].trim], [0.0]
    for leg in legs:
        if leg.to_trim is None:
            held[-1] += leg.duration
        else:
            trims.append(leg.to_trim)
            held.append(0.0)
    return trims, held


def downsample_leg(step: PlanStep, leg: Leg) -> FlownLeg:
    """Reduces a leg's track to points `TRACK_STEP` apart and both ends."""
    times = leg.track[:, 0]
    wanted = np.arange(times[0], times[-1], TRACK_STEP)
    rows = np.unique(np.minimum(np.append(np.searchsorted(times, wanted), len(times)), len(times) - 1))
    track = tuple((round(row[1], 3), round(row[2], 3)) for row in leg.track[rows].tolist())
    return FlownLeg(step.trim, step.to_trim, round(float(times[0]), 3), round(leg.duration, 3), track)
