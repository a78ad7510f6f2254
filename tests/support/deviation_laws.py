"""Distributions of deviations with exactly known joint coverage."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import brentq
from scipy.special import roots_hermitenorm
from scipy.stats import expon, norm, t

Array = Float[np.ndarray, "scalars"]


@dataclass(frozen=True)
class Law:
    """Distribution of a primitive's deviations, in units of its scales.

    Attributes:
        name: name in reports.
        draw: function (generator, samples, scalars) -> samples.
        inside: function (low, high) -> probability that every scalar is within its limits.
    """

    name: str
    draw: Callable[[np.random.Generator, int, int], Float[np.ndarray, "n scalars"]]
    inside: Callable[[Array, Array], float]

    def quantile(self, coverage: float, scalars: int) -> float:
        """Returns the half width of the cube that covers a share."""

        def excess(size: float) -> float:
            return self.inside(np.full(scalars, -size), np.full(scalars, size)) - coverage

        return float(brentq(excess, 1e-6, 1e3))


# One common factor gives every pair of scalars this correlation.
CORRELATION = 0.8
DEGREES_OF_FREEDOM = 3


def _normal(rng: np.random.Generator, count: int, scalars: int) -> Float[np.ndarray, "n scalars"]:
    return rng.standard_normal((count, scalars))


def _normal_inside(low: Array, high: Array) -> float:
    return float(np.prod(norm.cdf(high) - norm.cdf(low)))


def _heavy(rng: np.random.Generator, count: int, scalars: int) -> Float[np.ndarray, "n scalars"]:
    return np.asarray(rng.standard_t(DEGREES_OF_FREEDOM, (count, scalars)))


def _heavy_inside(low: Array, high: Array) -> float:
    return float(np.prod(t.cdf(high, DEGREES_OF_FREEDOM) - t.cdf(low, DEGREES_OF_FREEDOM)))


def _skewed(rng: np.random.Generator, count: int, scalars: int) -> Float[np.ndarray, "n scalars"]:
    return rng.exponential(size=(count, scalars)) - 1.0


def _skewed_inside(low: Array, high: Array) -> float:
    return float(np.prod(expon.cdf(high + 1.0) - expon.cdf(low + 1.0)))


def _correlated(rng: np.random.Generator, count: int, scalars: int) -> Float[np.ndarray, "n scalars"]:
    common, own = rng.standard_normal((count, 1)), rng.standard_normal((count, scalars))
    return np.asarray(np.sqrt(CORRELATION) * common + np.sqrt(1 - CORRELATION) * own)


def _correlated_inside(low: Array, high: Array) -> float:
    """Gauss-Hermite over the common factor; given it, the scalars are independent."""
    nodes, weights = _HERMITE
    shift, own = np.sqrt(CORRELATION) * nodes[:, None], np.sqrt(1 - CORRELATION)
    given = np.prod(norm.cdf((high - shift) / own) - norm.cdf((low - shift) / own), axis=1)
    return float(weights @ given / weights.sum())


_HERMITE = roots_hermitenorm(120)

LAWS = (
    Law("normal", _normal, _normal_inside),
    Law("heavy-tailed (t, 3)", _heavy, _heavy_inside),
    Law("skewed (exponential)", _skewed, _skewed_inside),
    Law("correlated 0.8", _correlated, _correlated_inside),
)
