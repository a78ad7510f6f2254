"""Gusts of straight flights against the standard's spectra.

Along-track and cross-track are along and across the motion through the air.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from math import atan2, cos, hypot, sin

import numpy as np
from jaxtyping import Float
from scipy.signal import lfilter, welch

from flight.units import FOOT
from sim.wind.dryden import AIRSPEED_FLOOR, Dryden, dryden
from sim.wind.wind import DrydenWind
from sim.wind.wind_class import WindClass

HEIGHT, SPAN = 30.0, 3.0
STEP = 0.05
COURSES = {"upwind": 0.0, "crosswind": np.pi / 2, "downwind": np.pi}
"""Directions of flight from the wind's origin, rad."""

_WIND = WindClass("test", 20.0 * FOOT)
_GROUND_SPEED, _PERIODS, _SEGMENT = 20.0, 60_000, 4096

Spectra = dict[str, tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]]


@dataclass(frozen=True)
class GustFlight:
    """Gusts of a straight flight at constant speed.

    Attributes:
        airspeed: horizontal speed through the mean wind, m/s.
        axis: direction of that velocity, rad clockwise from north, which is the wind's origin.
        gusts: velocity of the air less the mean wind, world axes, m/s.
        rates: gust rates, world axes, rad/s.
    """

    airspeed: float
    axis: float
    gusts: Float[np.ndarray, "n 3"]
    rates: Float[np.ndarray, "n 3"]

    def in_axes(self, vectors: Float[np.ndarray, "n 3"], axis: float) -> Float[np.ndarray, "n 3"]:
        """Returns world vectors in axes along a direction."""
        c, s = cos(axis), sin(axis)
        return np.asarray(vectors @ [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


@cache
def fly_course(course: str) -> GustFlight:
    """Flies straight at 20 m/s over the ground, wind from north."""
    angle, mean = COURSES[course], _WIND.mean_wind(HEIGHT)
    north, east = _GROUND_SPEED * cos(angle), _GROUND_SPEED * sin(angle)
    source = DrydenWind(
        _WIND, height=HEIGHT, span=SPAN, direction=0.0, step=STEP, rng=np.random.default_rng(7)
    )
    blown = np.array([source.step(velocity_north=north, velocity_east=east) for _ in range(_PERIODS)])
    # The mean wind blows to the south, at minus `mean`.
    gusts = blown[:, :3] + (mean, 0.0, 0.0)
    return GustFlight(hypot(north + mean, east), atan2(east, north + mean), gusts, blown[:, 3:])


def gust_spectra(flight: GustFlight, *, axis: float | None = None) -> tuple[np.ndarray, Spectra]:
    """Returns frequencies in rad/s, and measured and analytic spectra.

    Args:
        flight: gusts of a straight flight.
        axis: direction of the along-track gust, rad; along the motion through the air if None.
    """
    samples = flight.in_axes(flight.gusts, flight.axis if axis is None else axis)
    hertz, power = welch(samples, fs=1.0 / STEP, nperseg=_SEGMENT, axis=0)
    frequency, power = 2.0 * np.pi * hertz[1:], power[1:] / (2.0 * np.pi)
    model = dryden(_WIND.wind_at_20_ft, height=HEIGHT, span=SPAN)
    analytic = _analytic_spectra(model, max(flight.airspeed, AIRSPEED_FLOOR))
    names = ("along-track", "cross-track", "vertical")
    return frequency, {
        name: (power[:, place], analytic[place](frequency)) for place, name in enumerate(names)
    }


def spectrum_ratios(flight: GustFlight, *, axis: float | None = None) -> dict[str, float]:
    """Returns the mean ratio of measured and analytic spectrum.

    Frequencies are those below a tenth of the sampling frequency, where aliasing is small.
    """
    frequency, found = gust_spectra(flight, axis=axis)
    low = frequency < 0.1 * 2.0 * np.pi / STEP
    return {name: float(np.mean(power[low] / analytic[low])) for name, (power, analytic) in found.items()}


def rate_slopes(flight: GustFlight, *, axis: float | None = None) -> dict[str, float]:
    """Returns the slope of gust rates over the standard's.

    The standard's pitch rate is the change of w along the path, smoothed over 4 b / pi of it; its yaw rate is
    minus that of v, over 3 b / pi.

    Args:
        flight: gusts of a straight flight.
        axis: direction of x, rad; along the motion through the air if None.
    """
    along = flight.axis if axis is None else axis
    _, v, w = flight.in_axes(flight.gusts, along).T
    _, pitch, yaw = flight.in_axes(flight.rates, along).T
    found = {"pitch": (pitch, w, 4.0 * SPAN / np.pi), "yaw": (-yaw, v, 3.0 * SPAN / np.pi)}
    slopes = {}
    for name, (rate, gust, length) in found.items():
        keep = np.exp(-flight.airspeed * STEP / length)
        smooth, _ = lfilter([1.0 - keep], [1.0, -keep], gust, zi=[keep * gust[0]])
        standard = (gust - smooth) / length
        slopes[name] = float(rate @ standard / (standard @ standard))
    return slopes


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
