"""Safe envelope of a flight; a vehicle outside counts as lost."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from pydantic import PositiveFloat

from flight.file_value import FileValue
from flightlog.log import FlightLog
from flightlog.topics import COMMAND, ESTIMATE, TRUTH


@dataclass(frozen=True, slots=True)
class SafeEnvelope(FileValue):
    """Limits of a safe flight, at least twice those of fault-free flights.

    Attributes:
        tilt: roll or pitch, rad.
        height: deviation from the commanded height, m.
        position: horizontal position error of the estimate, m.
        heading: heading error of the estimate, rad.
    """

    tilt: PositiveFloat = 0.7
    height: PositiveFloat = 5.0
    position: PositiveFloat = 1.0
    heading: PositiveFloat = 0.35

    def __post_init__(self) -> None:
        """Checks that all limits are positive."""
        if not min(self.tilt, self.height, self.position, self.heading) > 0:
            raise ValueError(f"limits of an envelope must be > 0, got {self}")


DEFAULT_ENVELOPE = SafeEnvelope()


@dataclass(frozen=True, slots=True)
class EnvelopeExit:
    """Exit from the envelope: seconds since the start, and the reason."""

    time: float
    why: str


def first_exit(log: FlightLog, envelope: SafeEnvelope) -> EnvelopeExit | None:
    """Returns a flight's first exit from its envelope, or its loss.

    Raises:
        MissingTopicError: the log has no truth, estimate or command.
    """
    truth, estimate = log[TRUTH], log[ESTIMATE]
    if not len(truth):
        return EnvelopeExit(0.0, log.header.outcome)
    off = np.hypot(*(estimate[axis] - truth[axis] for axis in ("north", "east")))
    tilt = np.maximum(np.abs(truth["roll"]), np.abs(truth["pitch"]))
    turned = np.abs(np.remainder(estimate["heading"] - truth["heading"] + np.pi, 2 * np.pi) - np.pi)
    height = np.abs(truth["down"] + log[COMMAND]["height"])
    exits = [
        _exit(truth.time, tilt, envelope.tilt, "rad of roll or pitch"),
        _exit(truth.time, height, envelope.height, "m of height deviation"),
        _exit(truth.time, off, envelope.position, "m of position error of the estimate"),
        _exit(truth.time, turned, envelope.heading, "rad of heading error of the estimate"),
    ]
    if log.header.outcome != "completed":
        exits.append(EnvelopeExit(log.duration, log.header.outcome))
    return min((one for one in exits if one is not None), key=lambda one: one.time, default=None)


def _exit(
    times: Float[np.ndarray, "n"], values: Float[np.ndarray, "n"], limit: float, words: str
) -> EnvelopeExit | None:
    # `not inside` instead of `outside`, so that NaN counts as outside.
    outside = np.flatnonzero(~(values <= limit))
    return EnvelopeExit(float(times[outside[0]]), f"more than {limit:g} {words}") if len(outside) else None
