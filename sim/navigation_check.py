"""Whether the navigation filter's claims about its own error are true."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from .controller_check import fly_walk
from .figure import Figure
from .filter_equations import ESTIMATED
from .motion import Motion
from .navigation import Navigation
from .parameters import Parameters

FLIGHTS = 50
# Errors this far apart in time are taken as independent, s.
_APART = 5.0
_STEP = 0.01
_SECONDS = 60.0


def check_navigation(parameters: Parameters) -> Iterator[Figure]:
    """Yields the normalised estimation error over many sets of sensors, through every trim in wind."""
    flown = fly_walk(parameters, parameters, adaptive=True)
    truths = [Motion._make(row) for row in flown.motion.tolist()][: round(_SECONDS / _STEP)]
    normalised = np.array([_normalised(parameters, truths, seed) for seed in range(FLIGHTS)])
    mean = normalised.mean(axis=0)
    low, high = (chi2.ppf(share, ESTIMATED * FLIGHTS) / FLIGHTS for share in (0.025, 0.975))
    inside = float(((mean >= low) & (mean <= high)).mean())
    beside = f"{FLIGHTS} flights, {len(mean)} times {_APART:g} s apart, band {low:.2f} to {high:.2f}"
    yield Figure(
        "navigation", "share of times with the mean NEES in its 95 % band", inside, "-", 0.9, None, beside
    )
    yield Figure("navigation", "mean NEES", float(mean.mean()), "-", beside=f"{ESTIMATED} expected")


def flown_errors(parameters: Parameters, *, seed: int, seconds: float) -> Float[np.ndarray, "n 15"]:
    """Returns the errors of the estimate every second of a walk through the trims."""
    flown = fly_walk(parameters, parameters, adaptive=True)
    truths = [Motion._make(row) for row in flown.motion.tolist()][: round(seconds / _STEP)]
    navigation = _navigation(parameters, truths[0], seed)
    errors = []
    for period, truth in enumerate(truths[1:], start=1):
        navigation.step(truth)
        if period % 100 == 0:
            errors.append(navigation.error(truth))
    return np.array(errors)


def _normalised(parameters: Parameters, truths: list[Motion], seed: int) -> list[float]:
    navigation, found = _navigation(parameters, truths[0], seed), []
    apart = round(_APART / _STEP)
    for period, truth in enumerate(truths[1:], start=1):
        navigation.step(truth)
        if period % apart == 0:
            found.append(navigation.normalised_error(truth))
    return found


def _navigation(parameters: Parameters, truth: Motion, seed: int) -> Navigation:
    gravity, rng = parameters.environment.gravity, np.random.default_rng(seed)
    return Navigation(truth, step=_STEP, gravity=gravity, rng=rng)
