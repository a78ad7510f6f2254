"""Flight logs whose primitives deviate by given amounts.

The log has only the topics that identification reads. The rows of the truth are at the decisive instants:
entry, start and end of the dwell, command changes. So durations, displacements and coast deviations are
exact.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.mission.sequence import Sequence
from flight.se2 import SE2, Twist
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind
from flightlog.series import Series
from flightlog.topics import PRIMITIVE, TRUTH

# Seconds from a row outside the band to the start of the dwell.
_JUST_BEFORE = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class PlantedDeviations:
    """Deviations of one flight from the library's values.

    Attributes:
        trims: forward, side, yaw rate by trim id, at one instant of every coast; nominal otherwise.
        maneuvers: duration, forward, side, heading change by maneuver id.
    """

    trims: dict[int, Float[np.ndarray, "3"]]
    maneuvers: dict[int, Float[np.ndarray, "4"]]


def planted_log(
    library: Library, text: bytes, tour: Sequence, planted: PlantedDeviations, seed: int
) -> FlightLog:
    """Returns the log of a flight along a tour.

    Args:
        library: nominal values and the maneuver-end rule.
        text: library file to attach.
        tour: trims and coasting times.
        planted: deviations.
        seed: seed in the header.
    """
    rule = library.conditions.maneuver_end
    assert rule is not None, "a campaign's library has a rule"
    flight = _Rows(tour.start)
    first = library.trim(tour.trims[0])
    flight.begin(PrimitiveKind.COAST, first.id, first, first)
    flight.coast(first, planted.trims[first.id], tour.coasting_times[0])
    steps = zip(library.maneuvers_along(tour.trims), tour.coasting_times[1:], strict=True)
    for maneuver, coasting_time in steps:
        left, reached = library.trim(maneuver.from_trim), library.trim(maneuver.to_trim)
        flight.begin(PrimitiveKind.MANEUVER, maneuver.id, left, reached)
        flight.perform(maneuver, reached, planted.maneuvers[maneuver.id], rule.dwell)
        flight.begin(PrimitiveKind.COAST, reached.id, reached, reached)
        flight.coast(reached, planted.trims[reached.id], coasting_time)
    header = FlightHeader("campaign", tour.name, "planted", "0" * 64, seed, tour.wind, "0", "planted")
    series = {TRUTH.name: flight.truth(), PRIMITIVE.name: flight.primitives()}
    return FlightLog(header, series, {LIBRARY_ATTACHMENT: text})


class _Rows:
    """Growing rows of a log."""

    def __init__(self, start: SE2) -> None:
        self._time, self._pose = 0.0, start
        self._states: list[tuple[float, SE2, Twist]] = []
        self._begun: list[list[float]] = []

    def begin(self, kind: PrimitiveKind, number: int, left: Trim, reached: Trim) -> None:
        to = reached.velocity
        row = [self._time, kind, number, left.id, reached.id, to.forward, to.side, to.yaw_rate, 0.0]
        self._begun.append(row)

    def coast(self, trim: Trim, deviation: Float[np.ndarray, "3"], duration: float) -> None:
        off = Twist(*(np.array(_numbers(trim.velocity)) + deviation).tolist())
        for share, velocity in ((0.0, trim.velocity), (0.5, off), (1.0, trim.velocity)):
            self._state(self._time + share * duration, velocity)
        self._time += duration

    def perform(
        self, maneuver: Maneuver, reached: Trim, deviation: Float[np.ndarray, "4"], dwell: float
    ) -> None:
        late, forward, side, turned = deviation.tolist()
        duration = maneuver.duration + late
        assert duration > dwell + 2 * _JUST_BEFORE, "a planted maneuver lasts longer than its dwell"
        far = Twist(reached.velocity.forward + 10.0, reached.velocity.side, reached.velocity.yaw_rate)
        for time in (_JUST_BEFORE, duration - dwell - _JUST_BEFORE):
            self._state(self._time + time, far)
        self._state(self._time + duration - dwell, reached.velocity)
        moved = maneuver.displacement
        self._pose = self._pose @ SE2(moved.x + forward, moved.y + side, moved.heading + turned)
        self._time += duration
        self._state(self._time, reached.velocity)

    def _state(self, time: float, velocity: Twist) -> None:
        self._states.append((time, self._pose, velocity))

    def truth(self) -> Series:
        names = TRUTH.field_names
        values = np.zeros((len(self._states), len(names)))
        columns = [names.index(name) for name in ("north", "east", "heading", "forward", "side", "yaw_rate")]
        values[:, columns] = [
            (pose.x, pose.y, pose.heading, *_numbers(velocity)) for _, pose, velocity in self._states
        ]
        return Series(TRUTH, np.array([time for time, _, _ in self._states]), values)

    def primitives(self) -> Series:
        rows = np.array(self._begun)
        return Series(PRIMITIVE, rows[:, 0], rows[:, 1:])


def _numbers(velocity: Twist) -> tuple[float, float, float]:
    return velocity.forward, velocity.side, velocity.yaw_rate
