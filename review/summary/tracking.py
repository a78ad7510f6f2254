"""Tracking and navigation errors at the times of the true states."""

import numpy as np
from jaxtyping import Float

from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import COMMAND, ESTIMATE, TRUTH

VELOCITIES = ("forward", "side", "yaw_rate")
"""Fields of command, estimate and truth that a trim fixes."""


def interpolate_field(series: Series, field: str, time: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
    """Interpolates a field linearly."""
    return np.asarray(np.interp(time, series.time, series[field]))


def tracking_error(log: FlightLog, field: str) -> Float[np.ndarray, "n"]:
    """Returns truth minus command of a velocity.

    Raises:
        MissingTopicError: the log lacks command or truth.
    """
    truth = log[TRUTH]
    return np.asarray(truth[field] - interpolate_field(log[COMMAND], field, truth.time))


def navigation_error(log: FlightLog, field: str) -> Float[np.ndarray, "n"]:
    """Returns estimate minus truth of a state's field; angles are wrapped.

    Raises:
        MissingTopicError: the log lacks estimate or truth.
    """
    truth = log[TRUTH]
    error = np.asarray(interpolate_field(log[ESTIMATE], field, truth.time) - truth[field])
    return np.asarray(np.remainder(error + np.pi, 2 * np.pi) - np.pi) if field == "heading" else error
