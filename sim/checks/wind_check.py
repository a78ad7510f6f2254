"""Checks of the Dryden turbulence: covariance, ensembles and spectra."""

from collections.abc import Callable, Iterator

import casadi as ca
import numpy as np
from jaxtyping import Float
from scipy.linalg import solve_discrete_lyapunov
from scipy.signal import welch

from sim.wind.dryden import AIRSPEED_FLOOR, Dryden, LateralGust, dryden, step_longitudinal
from sim.wind.wind import DrydenWind, WindClass

from .check_result import CheckResult

FIXED_POINT_LIMIT = 1e-9
# Step over the filter's time constant, from 0.1 ms in a slow gust to many time constants.
RATIOS = (1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0)
_HEIGHT, _SPAN, _SPEED = 30.0, 3.0, 10.0
_TEST = WindClass("test", 10.0, 0.0)
_SOURCES = 800


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
    for name, ratio in spectrum_ratios().items():
        yield CheckResult("wind", f"spectrum of {name}, measured / analytic, mean", ratio, "-", 0.9, 1.1)


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
    model = dryden(_TEST.wind_at_20_ft, height=_HEIGHT, span=_SPAN)
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
    return DrydenWind(_TEST, height=_HEIGHT, span=_SPAN, direction=0.0, step=step, rng=rng)


def gust_spectra() -> tuple[Float[np.ndarray, "n"], dict[str, tuple[np.ndarray, np.ndarray]]]:
    """Returns frequencies in rad/s, and measured and analytic gust spectra."""
    step, periods = 0.05, 100_000
    source = _source(7, step)
    blown = np.array([source.step(velocity_north=_SPEED, velocity_east=0.0)[:3] for _ in range(periods)])
    hertz, power = welch(blown, fs=1.0 / step, nperseg=4096, axis=0)
    frequency, power = 2.0 * np.pi * hertz[1:], power[1:] / (2.0 * np.pi)
    model = dryden(_TEST.wind_at_20_ft, height=_HEIGHT, span=_SPAN)
    analytic = _analytic_spectra(model, max(_SPEED, AIRSPEED_FLOOR))
    return frequency, {
        name: (power[:, place], analytic[place](frequency)) for place, name in enumerate(("u", "v", "w"))
    }


def _analytic_spectra(model: Dryden, speed: float) -> tuple[Callable[[np.ndarray], np.ndarray], ...]:
    """Returns the one-sided spectra of MIL-F-8785C, 3.7.1.2, over rad/s."""

    def longitudinal(frequency: np.ndarray) -> np.ndarray:
        tau = model.length_horizontal / speed
        return np.asarray(2.0 * model.sigma_horizontal**2 * tau / np.pi / (1.0 + (tau * frequency) ** 2))

    def lateral(sigma: float, length: float) -> Callable[[np.ndarray], np.ndarray]:
        tau = length / speed
        return lambda frequency: np.asarray(
            sigma**2
            * tau
            / np.pi
            * (1.0 + 3.0 * (tau * frequency) ** 2)
            / (1.0 + (tau * frequency) ** 2) ** 2
        )

    return (
        longitudinal,
        lateral(model.sigma_horizontal, model.length_horizontal),
        lateral(model.sigma_vertical, model.length_vertical),
    )


def spectrum_ratios() -> dict[str, float]:
    """Returns the mean ratio of measured and analytic spectrum.

    Frequencies are those below a fifth of the sampling frequency.
    """
    frequency, found = gust_spectra()
    low = frequency < 0.2 * 2.0 * np.pi / 0.05
    return {name: float(np.mean(power[low] / analytic[low])) for name, (power, analytic) in found.items()}
