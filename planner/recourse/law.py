"""Transition law of a library: distributions of its primitives as executed.

Where a library has no identified law its errors are taken as one by a rule: numbers are independent and
normal, with mean and standard deviation of the statistics, or else with the library's value as mean and half
the error as standard deviation. A trim's velocity then stays what it is for a whole coast.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.statistics import Statistics
from flight.automaton.trim import Trim

ERROR_DEVIATIONS = 2.0
"""Standard deviations that an error is taken for where no statistics are given."""

PATH_SHARES = 9
"""Instants of a maneuver's mean path, at equal shares of its duration."""

_MANEUVER = ("duration", "forward", "side", "heading_change")
_TRIM = ("forward", "side", "yaw_rate")


@dataclass(frozen=True, slots=True, eq=False)
class ManeuverDistribution:
    """Distribution of a maneuver's duration and displacement.

    Attributes:
        mean: seconds, metres forward, metres to the right, radians.
        covariance: of the same.
        path: mean forward, side and heading in the body frame at entry, at equal shares of the duration.
    """

    mean: Float[np.ndarray, "4"]
    covariance: Float[np.ndarray, "4 4"]
    path: Float[np.ndarray, "instants 3"]


@dataclass(frozen=True, slots=True, eq=False)
class CoastDistribution:
    """Distribution of a trim's velocity over a coast.

    Attributes:
        mean: metres per second forward, to the right, radians per second.
        covariance: of a coast's mean velocity, apart from what varies within it.
        within: standard deviations of the velocity within a coast.
        correlation_time: seconds, of the same.
    """

    mean: Float[np.ndarray, "3"]
    covariance: Float[np.ndarray, "3 3"]
    within: Float[np.ndarray, "3"]
    correlation_time: Float[np.ndarray, "3"]

    def averaged(self, duration: float) -> Float[np.ndarray, "3 3"]:
        """Returns the covariance of the mean velocity over a coast in seconds.

        Within a coast the velocity is a first-order Gauss-Markov process.
        """
        memory = self.correlation_time
        drift = 2 * self.within**2 * memory * (duration - memory * (1 - np.exp(-duration / memory)))
        return np.asarray(self.covariance + np.diag(drift) / duration**2)


@dataclass(frozen=True, slots=True, eq=False)
class TransitionLaw:
    """Distributions of all primitives, in the library's order."""

    trims: tuple[CoastDistribution, ...]
    maneuvers: tuple[ManeuverDistribution, ...]


def transition_law(library: Library, *, error_scale: float = 1.0) -> TransitionLaw:
    """Returns the law of a library, its deviations scaled.

    Args:
        library: the primitives.
        error_scale: factor of all standard deviations; means stay.
    """
    trims = tuple(_coast_distribution(trim, error_scale) for trim in library.trims)
    place = {trim.id: law for trim, law in zip(library.trims, trims, strict=True)}
    maneuvers = tuple(
        _maneuver_distribution(one, place[one.from_trim].mean, place[one.to_trim].mean, error_scale)
        for one in library.maneuvers
    )
    return TransitionLaw(trims, maneuvers)


def _coast_distribution(trim: Trim, scale: float) -> CoastDistribution:
    velocity, error, law = trim.velocity, trim.error, trim.law
    if law is not None:
        return CoastDistribution(
            np.array([law.mean.forward, law.mean.side, law.mean.yaw_rate]),
            scale**2 * np.array(law.covariance),
            scale * np.array(law.within.standard_deviation),
            np.array(law.within.correlation_time),
        )
    mean, deviation = _moments(
        trim.statistics,
        _TRIM,
        [getattr(velocity, one) for one in _TRIM],
        [getattr(error, one) for one in _TRIM],
    )
    return CoastDistribution(mean, np.diag((scale * deviation) ** 2), np.zeros(3), np.ones(3))


def _maneuver_distribution(
    one: Maneuver, entry: Float[np.ndarray, "3"], exit_: Float[np.ndarray, "3"], scale: float
) -> ManeuverDistribution:
    if one.law is not None:
        path = np.array([instant.mean for instant in one.law.path])
        return ManeuverDistribution(np.array(one.law.mean), scale**2 * np.array(one.law.covariance), path)
    moved = one.displacement
    mean, deviation = _moments(
        one.statistics,
        _MANEUVER,
        [one.duration, moved.x, moved.y, moved.heading],
        [getattr(one.error, name) for name in _MANEUVER],
    )
    path = hermite_path(mean, entry, exit_)
    return ManeuverDistribution(mean, np.diag((scale * deviation) ** 2), path)


def _moments(
    statistics: Statistics | None, names: tuple[str, ...], values: list[float], errors: list[float]
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Returns means and standard deviations, of the statistics where given."""
    known = {} if statistics is None else {row.name: row for row in statistics.scalars}
    mean = [known[name].mean if name in known else value for name, value in zip(names, values, strict=True)]
    deviation = [
        known[name].standard_deviation if name in known else abs(error) / ERROR_DEVIATIONS
        for name, error in zip(names, errors, strict=True)
    ]
    return np.array(mean), np.array(deviation)


def hermite_path(
    mean: Float[np.ndarray, "4"], entry: Float[np.ndarray, "3"], exit_: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "instants 3"]:
    """Returns a path between two trims where none was identified.

    Forward and side are the cubics with the velocities of both trims at their ends; the heading is the cubic
    with both yaw rates.

    Args:
        mean: duration and displacement.
        entry: velocity of the trim that is left.
        exit_: velocity of the trim that is entered, in its own body frame.
    """
    duration, turn = mean[0], mean[3]
    cosine, sine = np.cos(turn), np.sin(turn)
    leaving = np.array([exit_[0] * cosine - exit_[1] * sine, exit_[0] * sine + exit_[1] * cosine, exit_[2]])
    share = np.linspace(0.0, 1.0, PATH_SHARES)[:, None]
    begin = share * (1 - share) ** 2 * duration * entry
    end = share**2 * (share - 1) * duration * leaving
    return np.asarray(begin + end + share**2 * (3 - 2 * share) * mean[1:])
