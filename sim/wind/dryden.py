"""Dryden turbulence of MIL-F-8785C at low altitude, discretised exactly.

The spectra are those of the standard at the current airspeed and height, with a lower bound of the airspeed
for hover, where a frozen field would not move past the vehicle. The discretisation is exact for any airspeed
and step, so both may change at every step.

Axes of the gusts: x along the vehicle's horizontal velocity through the mean wind, y to its right, z down.
When that direction turns, the gust vector stays where it was in the world.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import cos, pi, sin, sqrt
from typing import Any, NamedTuple

import casadi as ca
import numpy as np
from jaxtyping import Float

from flight.units import FOOT
from sim.loop.motion import Estimate

from .wind_class import wind_profile

# Lower bound of the airspeed, because a frozen field is no model for hover, m/s.
AIRSPEED_FLOOR = 4.0
# Airspeed below which the axes keep their direction, m/s.
_NO_DIRECTION = 1e-9
# Heights of the low-altitude model, m.
_LOWEST, _HIGHEST = 10.0 * FOOT, 1000.0 * FOOT
# Lateral gust as a combination of its two states.
_READOUT = (sqrt(3.0), 1.0 - sqrt(3.0))
# Change of the two states with the gust; their uncorrelated combination x0 - (1 + sqrt(3)) x1 is kept.
_TURN = ((1.0 + sqrt(3.0)) / 4.0, 0.25)


@dataclass(frozen=True, slots=True)
class Dryden:
    """Turbulence of the standard at one height (MIL-F-8785C, 3.7.3.4).

    Attributes:
        sigma_horizontal: standard deviation of the gusts along x and y, m/s.
        sigma_vertical: standard deviation of the gusts along z, m/s.
        length_horizontal: length scale of the gusts along x and y, m.
        length_vertical: length scale of the gusts along z, m.
        span: span of the vehicle, for gust rates, m.
    """

    sigma_horizontal: float
    sigma_vertical: float
    length_horizontal: float
    length_vertical: float
    span: float

    @property
    def sigma_roll_rate(self) -> float:
        """Standard deviation of the gust roll rate, rad/s, from the standard's spectrum."""
        shape = 0.8 * pi**2 / (8.0 * self.span) * (pi / (4.0 * self.span)) ** (1.0 / 3.0)
        sigma: float = self.sigma_vertical * sqrt(shape) / self.length_vertical ** (1.0 / 3.0)
        return sigma


def dryden(wind_at_20_ft: float, *, height: float, span: float) -> Dryden:
    """Returns the low-altitude model of MIL-F-8785C, also of symbols.

    Args:
        wind_at_20_ft: wind at 20 ft, m/s.
        height: height above ground, m, clamped to 10 to 1000 ft.
        span: span of the vehicle, m.
    """
    height_ft = ca.fmax(_LOWEST, ca.fmin(_HIGHEST, height)) / FOOT
    factor = 0.177 + 0.000823 * height_ft
    sigma_vertical = 0.1 * wind_at_20_ft
    return Dryden(
        sigma_horizontal=sigma_vertical / factor**0.4,
        sigma_vertical=sigma_vertical,
        length_horizontal=height_ft / factor**1.2 * FOOT,
        length_vertical=height_ft * FOOT,
        span=span,
    )


def step_longitudinal(value: ca.SX, *, ratio: ca.SX, noise: ca.SX) -> ca.SX:
    """Returns a unit u gust `ratio` time constants later."""
    keep = ca.exp(-ratio)
    return keep * value + ca.sqrt(1.0 - keep * keep) * noise


class LateralGust(NamedTuple):
    """Unit v or w gust of the standard, by its two states."""

    x0: ca.SX
    x1: ca.SX

    @property
    def value(self) -> ca.SX:
        """Gust in units of its standard deviation."""
        return _READOUT[0] * self.x0 + _READOUT[1] * self.x1

    def turn(self, change: ca.SX) -> "LateralGust":
        """Returns the gust changed by a turn of its axes, still stationary."""
        return LateralGust(self.x0 + _TURN[0] * change, self.x1 + _TURN[1] * change)

    def step(self, *, ratio: ca.SX, noise: tuple[ca.SX, ca.SX]) -> "LateralGust":
        """Returns the gust `ratio` time constants later."""
        e = ca.exp(-ratio)
        e2 = e * e
        q00 = 0.5 * (1.0 - e2)
        q01 = 0.25 * (1.0 - e2 * (1.0 + 2.0 * ratio))
        q11 = 0.25 * (1.0 - e2 * (1.0 + 2.0 * ratio + 2.0 * ratio * ratio))
        l00 = ca.sqrt(q00)
        l10 = q01 / l00
        l11 = ca.sqrt(ca.fmax(0.0, q11 - l10 * l10))
        return LateralGust(
            e * self.x0 + l00 * noise[0],
            e * self.x1 + ratio * e * self.x0 + l10 * noise[0] + l11 * noise[1],
        )


class Turbulence(NamedTuple):
    """State of the air: unit gusts, smoothed gusts, direction of x.

    The smoothed gusts, in m/s, start without slope; their transient of a second is over before the flight
    starts. The direction is its cosine and sine, clockwise from north.
    """

    u: ca.SX
    v0: ca.SX
    v1: ca.SX
    w0: ca.SX
    w1: ca.SX
    p: ca.SX
    u_smooth: ca.SX
    v_smooth: ca.SX
    w_smooth: ca.SX
    axis_north: ca.SX
    axis_east: ca.SX


class MeanWind(NamedTuple):
    """Mean wind: at 20 ft in m/s, with its direction of origin."""

    wind_at_20_ft: ca.SX
    from_north: ca.SX
    from_east: ca.SX


def draw_turbulence(model: Dryden, noise: Sequence[float], *, direction: float) -> Float[np.ndarray, "11"]:
    """Returns stationary turbulence, laid out as `Turbulence`.

    Args:
        model: turbulence model.
        noise: 6 standard normal numbers.
        direction: direction of x, rad clockwise from north.
    """
    gusts = []
    for first, second in (noise[1:3], noise[3:5]):
        # Stationary distribution of a lateral gust: variances 1/2 and 1/4, covariance 1/4.
        x0 = sqrt(0.5) * first
        gusts.append((x0, 0.5 * x0 + sqrt(0.125) * second))
    v, w = (_READOUT[0] * x0 + _READOUT[1] * x1 for x0, x1 in gusts)
    smooth = (model.sigma_horizontal * noise[0], model.sigma_horizontal * v, model.sigma_vertical * w)
    axes = (cos(direction), sin(direction))
    return np.array([noise[0], *gusts[0], *gusts[1], noise[5], *smooth, *axes])


def _turn_axes(before: Turbulence, north: ca.SX, east: ca.SX) -> Turbulence:
    """Returns the same gust vectors in axes along another direction."""
    c = north * before.axis_north + east * before.axis_east
    s = east * before.axis_north - north * before.axis_east
    lateral = LateralGust(before.v0, before.v1)
    u, v = before.u, lateral.value
    v0, v1 = lateral.turn(c * v - s * u - v)
    return before._replace(
        u=c * u + s * v,
        v0=v0,
        v1=v1,
        u_smooth=c * before.u_smooth + s * before.v_smooth,
        v_smooth=c * before.v_smooth - s * before.u_smooth,
        axis_north=north,
        axis_east=east,
    )


@cache
def wind_function(span: float, step: float) -> ca.Function:
    """Builds one period of the air past a vehicle's span, m.

    Returns:
        (motion, noise, mean, memory) -> (wind, memory): motion of the vehicle, 6 standard normal numbers,
        `MeanWind`, `Turbulence`.
    """
    motion, noise = ca.SX.sym("motion", len(Estimate._fields)), ca.SX.sym("noise", 6)
    air, memory = ca.SX.sym("air", len(MeanWind._fields)), ca.SX.sym("memory", len(Turbulence._fields))
    vehicle, mean = Estimate._make(ca.vertsplit(motion)), MeanWind._make(ca.vertsplit(air))
    before = Turbulence._make(ca.vertsplit(memory))
    # Symbols in formulas that are typed for numbers.
    wind_at_20_ft: Any = mean.wind_at_20_ft
    height: Any = -vehicle.down
    model = dryden(wind_at_20_ft, height=height, span=span)
    speed = wind_at_20_ft * wind_profile(height)
    mean_north, mean_east = -speed * mean.from_north, -speed * mean.from_east
    ahead, aside = ca.cos(vehicle.heading), ca.sin(vehicle.heading)
    north = ahead * vehicle.forward - aside * vehicle.side - mean_north
    east = aside * vehicle.forward + ahead * vehicle.side - mean_east
    airspeed = ca.sqrt(north**2 + east**2)
    moves = airspeed > _NO_DIRECTION
    divisor = ca.fmax(_NO_DIRECTION, airspeed)
    c = ca.if_else(moves, north / divisor, before.axis_north)
    s = ca.if_else(moves, east / divisor, before.axis_east)
    before = _turn_axes(before, c, s)
    travelled = ca.fmax(AIRSPEED_FLOOR, airspeed) * step
    along, down = travelled / model.length_horizontal, travelled / model.length_vertical
    n = ca.vertsplit(noise)
    unit_u = step_longitudinal(before.u, ratio=along, noise=n[0])
    unit_v = LateralGust(before.v0, before.v1).step(ratio=along, noise=(n[1], n[2]))
    unit_w = LateralGust(before.w0, before.w1).step(ratio=down, noise=(n[3], n[4]))
    u, v = model.sigma_horizontal * unit_u, model.sigma_horizontal * unit_v.value
    w = model.sigma_vertical * unit_w.value
    # Smoothing lengths of the standard: 4 b / pi for roll and pitch, 3 b / pi for yaw.
    long, short = 4.0 * span / pi, 3.0 * span / pi
    unit_p = step_longitudinal(before.p, ratio=travelled / long, noise=n[5])
    # Pitch and yaw gust of the standard: derivative of the gust along x, smoothed over the span.
    w_smooth = w + (before.w_smooth - w) * ca.exp(-travelled / long)
    u_smooth, v_smooth = (
        gust + (smooth - gust) * ca.exp(-travelled / short)
        for gust, smooth in ((u, before.u_smooth), (v, before.v_smooth))
    )
    p, q, r = model.sigma_roll_rate * unit_p, (w - w_smooth) / long, -(v - v_smooth) / short
    gusts = (mean_north + c * u - s * v, mean_east + s * u + c * v, w)
    wind = ca.vertcat(*gusts, c * p - s * q, s * p + c * q, r)
    after = Turbulence(unit_u, *unit_v, *unit_w, unit_p, u_smooth, v_smooth, w_smooth, c, s)
    return ca.Function("blow", [motion, noise, air, memory], [wind, ca.vertcat(*after)])
