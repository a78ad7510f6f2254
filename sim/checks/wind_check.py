"""Checks of the Dryden turbulence: covariance, ensembles and spectra."""

from collections.abc import Iterator

import casadi as ca
import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from sim.wind.dryden import LateralGust, dryden, step_longitudinal
from sim.wind.wind import DrydenWind
from sim.wind.wind_class import WindClass

from .check_result import CheckResult
from .gust_spectra import COURSES, HEIGHT, SPAN, fly_course, rate_slopes, spectrum_ratios

FIXED_POINT_LIMIT = 1e-9
# Step over the filter's time constant, from 0.1 ms in a slow gust to many time constants.
RATIOS = (1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0)
_TEST = WindClass("test", 10.0)
_SOURCES = 800
SPECTRUM_LIMITS = (0.9, 1.1)
RATE_LIMITS = (0.99, 1.01)


def check_wind() -> Iterator[CheckResult]:
    """Yields covariance errors, ensemble errors and spectra."""
    for ratio in RATIOS:
        for name, variance in (("u", _longitudinal_variance(ratio)), ("v and w", lateral_variance(ratio))):
            off = abs(variance - 1.0)
            beside = "error of the variance over sigma^2"
            yield CheckResult(
                "wind",
                f"stationary variance of {name}, step {ratio:g} tau",
                off,
                "-",
                None,
                FIXED_POINT_LIMIT,
                beside,
            )
    yield from _check_ensembles()
    yield from _check_courses()


def _check_courses() -> Iterator[CheckResult]:
    """Yields spectra and gust rates of flights upwind, crosswind and downwind."""
    for course in COURSES:
        flight = fly_course(course)
        beside = f"airspeed {flight.airspeed:.1f} m/s"
        for name, ratio in spectrum_ratios(flight).items():
            label = f"{course}, {name} spectrum, measured / analytic, mean"
            yield CheckResult("wind", label, ratio, "-", *SPECTRUM_LIMITS, beside)
        for name, slope in rate_slopes(flight).items():
            label = f"{course}, gust {name} rate, slope over the standard's"
            yield CheckResult("wind", label, slope, "-", *RATE_LIMITS, beside)


def lateral_variance(ratio: float) -> float:
    """Returns the stationary variance of the discrete v and w filter.

    Args:
        ratio: step over time constant.
    """
    state, noise = ca.SX.sym("state", 2), ca.SX.sym("noise", 2)
    gust = LateralGust(*ca.vertsplit(state))
    after = ca.vertcat(*gust.step(ratio=ca.SX(ratio), noise=(noise[0], noise[1])))
    pairs = ((after, state), (after, noise), (gust.value, state))
    transition, drive, readout = (np.array(ca.evalf(ca.jacobian(of, to))) for of, to in pairs)
    covariance = solve_discrete_lyapunov(transition, drive @ drive.T)
    return float((readout @ covariance @ readout.T)[0, 0])


def _longitudinal_variance(ratio: float) -> float:
    kept, driven = (
        float(ca.evalf(step_longitudinal(ca.SX(value), ratio=ca.SX(ratio), noise=ca.SX(noise))))
        for value, noise in ((1.0, 0.0), (0.0, 1.0))
    )
    return driven**2 / (1.0 - kept**2)


def _check_ensembles() -> Iterator[CheckResult]:
    """Yields errors of ensemble standard deviations, in standard errors."""
    model = dryden(_TEST.wind_at_20_ft, height=HEIGHT, span=SPAN)
    sigmas = (model.sigma_horizontal, model.sigma_horizontal, model.sigma_vertical, model.sigma_roll_rate)
    for step in (0.01, 1.0):
        last = np.array([list(_gust_samples(seed, step=step, periods=10)) for seed in range(_SOURCES)])
        errors = np.abs(last[:, :4].std(axis=0) / sigmas - 1.0) * np.sqrt(2.0 * _SOURCES)
        for name, error in zip(("u", "v", "w", "p"), errors.tolist(), strict=True):
            label = f"ensemble of {name}, step {step:g} s, error"
            yield CheckResult("wind", label, error, "standard errors", high=4.0, beside=f"{_SOURCES} sources")


def _gust_samples(seed: int, *, step: float, periods: int) -> tuple[float, ...]:
    source = _source(seed, step)
    for _ in range(periods):
        wind = source.step(velocity_north=0.0, velocity_east=0.0)
    return tuple(wind)


def _source(seed: int, step: float) -> DrydenWind:
    rng = np.random.default_rng(seed)
    return DrydenWind(_TEST, height=HEIGHT, span=SPAN, direction=0.0, step=step, rng=rng)
