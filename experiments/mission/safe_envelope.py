"""The safe envelope of a flight, held against what is true: where a vehicle counts as lost."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from pydantic import PositiveFloat

from flight.file_value import FileValue
from flightlog.channels import COMMAND, ESTIMATE, TRUTH
from flightlog.log import FlightLog


@dataclass(frozen=True, slots=True)
class SafeEnvelope(FileValue):
    """How far a flight may go; twice what sound flights in moderate wind come to, or more.

    Attributes:
        tilt: roll or pitch, rad.
        height: off the one held, m.
        position: horizontal, of what is believed from what is so, m.
        heading: likewise, rad.
    """

    tilt: PositiveFloat = 0.7
    height: PositiveFloat = 5.0
    position: PositiveFloat = 1.0
    heading: PositiveFloat = 0.35

    def __post_init__(self) -> None:
        """Refuses an envelope that nothing is inside of."""
        if not min(self.tilt, self.height, self.position, self.heading) > 0:
            raise ValueError(f"an envelope's numbers must be > 0, got {self}")


DEFAULT_ENVELOPE = SafeEnvelope()


@dataclass(frozen=True, slots=True)
class EnvelopeExit:
    """Where a flight left its envelope: seconds since the start, and why, one sentence."""

    time: float
    why: str


def first_exit(log: FlightLog, envelope: SafeEnvelope) -> EnvelopeExit | None:
    """Returns where a flight first left its envelope, or was lost; None where it did not.

    Raises:
        MissingTopicError: the log has no truth, estimate or command.
    """
    truth, believed = log[TRUTH], log[ESTIMATE]
    if not len(truth):
        return EnvelopeExit(0.0, log.header.outcome)
    off = np.hypot(*(believed[axis] - truth[axis] for axis in ("north", "east")))
    tilt = np.maximum(np.abs(truth["roll"]), np.abs(truth["pitch"]))
    turned = np.abs(np.remainder(believed["heading"] - truth["heading"] + np.pi, 2 * np.pi) - np.pi)
    height = np.abs(truth["down"] + log[COMMAND]["height"])
    exits = [
        _exit(truth.time, tilt, envelope.tilt, "rad of roll or pitch"),
        _exit(truth.time, height, envelope.height, "m off the height held"),
        _exit(truth.time, off, envelope.position, "m position error of the estimate"),
        _exit(truth.time, turned, envelope.heading, "rad heading error of the estimate"),
    ]
    if log.header.outcome != "completed":
        exits.append(EnvelopeExit(log.duration, log.header.outcome))
    return min((one for one in exits if one is not None), key=lambda one: one.time, default=None)


def _exit(
    times: Float[np.ndarray, "n"], values: Float[np.ndarray, "n"], limit: float, words: str
) -> EnvelopeExit | None:
    # Not inside, rather than outside: what is no number is not inside.
    outside = np.flatnonzero(~(values <= limit))
    return EnvelopeExit(float(times[outside[0]]), f"more than {limit:g} {words}") if len(outside) else None
