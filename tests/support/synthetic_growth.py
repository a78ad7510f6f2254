"""Library of a vehicle with known responses and standard deviations."""

from dataclasses import replace

import numpy as np

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.sign_convention import signed_maneuver_error, signed_trim_error
from flight.automaton.statistics import ScalarStatistics, Statistics
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist
from identification.design.trend_automaton import turns_automaton
from identification.interpolation.step_baseline import Baseline, VelocityStep
from identification.segmentation.second_order_response import StepResponse

TRUTH = Baseline(StepResponse(0.7, 0.75), StepResponse(1.3, 0.7), dwell=1.0, timeout=15.0)


def scatter(velocity: Twist) -> float:
    """Returns the scale of deviations relative to hover: smooth, not linear."""
    return 1 + 0.1 * velocity.forward + velocity.yaw_rate**2


def flown_library(*, shrunken: float = 1.0) -> Library:
    """Returns the turns automaton of a known vehicle, with statistics."""
    automaton = turns_automaton(wind="calm", altitude=30.0)
    rule = automaton.conditions.maneuver_end
    assert rule is not None
    rng = np.random.default_rng(1)
    trims = tuple(_flown_trim(trim, rng, shrunken) for trim in automaton.trims)
    maneuvers = tuple(_flown(automaton, row, rng, shrunken) for row in automaton.maneuvers)
    return replace(automaton, trims=trims, maneuvers=maneuvers)


def _statistics(names: tuple[str, ...], means: list[float], largest: list[float]) -> Statistics:
    rows = zip(names, means, largest, strict=True)
    scalars = tuple(ScalarStatistics(name, mean, size / 2, size) for name, mean, size in rows)
    return Statistics(12, 0, 0.6, 0.95, scalars)


def _flown_trim(trim: Trim, rng: np.random.Generator, shrunken: float) -> Trim:
    size = scatter(trim.velocity) * shrunken * rng.uniform(0.85, 1.15, 3) * (0.1, 0.1, 0.03)
    error = signed_trim_error(Twist(*size.tolist()), trim.velocity)
    return replace(
        trim, error=error, statistics=_statistics(("forward", "side", "yaw_rate"), [0.0] * 3, size.tolist())
    )


def _flown(library: Library, row: Maneuver, rng: np.random.Generator, shrunken: float) -> Maneuver:
    edge, size = true_velocity_step(library, row), np.array([0.2, 0.3, 0.3, 0.05])
    size = size * scatter(edge.reached) * shrunken
    mean = np.array(TRUTH.maneuver(edge)) + 0.1 * size * rng.uniform(-1, 1, 4)
    size = size * rng.uniform(0.85, 1.15, 4)
    error = signed_maneuver_error(ManeuverError(*size.tolist()), left=edge.left, reached=edge.reached)
    names = ("duration", "forward", "side", "heading_change")
    return replace(
        row,
        duration=float(mean[0]),
        displacement=SE2(*mean[1:].tolist()),
        error=error,
        statistics=_statistics(names, mean.tolist(), size.tolist()),
    )


def true_velocity_step(library: Library, row: Maneuver) -> VelocityStep:
    rule = library.conditions.maneuver_end
    assert rule is not None
    left, reached = library.trim(row.from_trim), library.trim(row.to_trim)
    return VelocityStep(left.velocity, reached.velocity, rule.bands[row.to_trim])
