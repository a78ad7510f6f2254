"""Tests of the wind: Dryden statistics, calm air and seeds."""

from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from scenarios.find import find_library
from sim.checks.gust_spectra import COURSES, fly_course, rate_slopes, spectrum_ratios
from sim.checks.wind_check import (
    FIXED_POINT_LIMIT,
    RATE_LIMITS,
    RATIOS,
    SPECTRUM_LIMITS,
    check_wind,
    lateral_variance,
)
from sim.loop.motion import STILL_AIR, Wind
from sim.vehicle.parameters import read_parameters
from sim.wind.air_statement import state_wind
from sim.wind.discrete_gust import DiscreteGust
from sim.wind.dryden import dryden
from sim.wind.flyable import UnflyableWindError, check_flyable, held_airspeed
from sim.wind.wind import DrydenWind
from sim.wind.wind_class import WIND_CLASSES, UnknownWindError, WindClass, wind_class

FOOT = 0.3048


def blow(
    wind: WindClass, *, seed: int, periods: int, step: float = 0.01, direction: float | None = 0.0
) -> np.ndarray:
    source = DrydenWind(
        wind, height=30.0, span=3.0, direction=direction, step=step, rng=np.random.default_rng(seed)
    )
    return np.array([source.step(velocity_north=0.0, velocity_east=0.0) for _ in range(periods)])


def test_the_low_altitude_model_is_that_of_the_standard() -> None:
    # MIL-F-8785C, 3.7.3.4: at 100 ft the horizontal scale is 505 ft; above 1000 ft all is alike.
    model = dryden(10.0, height=100.0 * FOOT, span=3.0)
    assert model.length_vertical == pytest.approx(100.0 * FOOT)
    assert model.length_horizontal == pytest.approx(505.0 * FOOT, rel=0.005)
    assert model.sigma_vertical == 1.0
    top = dryden(10.0, height=1000.0 * FOOT, span=3.0)
    assert top.length_horizontal == pytest.approx(top.length_vertical, rel=1e-6)
    assert top.sigma_horizontal == pytest.approx(top.sigma_vertical, rel=1e-6)


@pytest.mark.parametrize("step", [0.01, 1.0, 30.0])
def test_gusts_keep_their_strength_at_every_step(step: float) -> None:
    wind = WindClass("test", 10.0)
    model = dryden(10.0, height=30.0, span=3.0)
    # Ensemble: the last of 40 periods of 2000 sources each, so that samples are independent.
    last = np.array(
        [blow(wind, seed=seed, periods=3 if step < 1.0 else 40, step=step)[-1] for seed in range(2000)]
    )
    sigmas = (model.sigma_horizontal, model.sigma_horizontal, model.sigma_vertical, model.sigma_roll_rate)
    # The standard error of a standard deviation from 2000 samples is 1.6 %; four of them.
    np.testing.assert_allclose(last[:, :4].std(axis=0), sigmas, rtol=0.064)
    mean = (-wind.mean_wind(30.0), 0.0, 0.0)
    np.testing.assert_allclose(last[:, :3].mean(axis=0), mean, atol=4 * model.sigma_horizontal / sqrt(2000))


def test_gusts_along_the_wind_forget_exponentially() -> None:
    series = blow(WindClass("test", 10.0), seed=3, periods=200_000, step=0.5)[:, 0]
    series = series - series.mean()
    model = dryden(10.0, height=30.0, span=3.0)
    lag = round(model.length_horizontal / WindClass("test", 10.0).mean_wind(30.0) / 0.5)
    correlation = np.mean(series[:-lag] * series[lag:]) / series.var()
    assert correlation == pytest.approx(np.exp(-1.0), abs=0.05)


def test_calm_is_still_air() -> None:
    assert (blow(wind_class("calm"), seed=1, periods=100) == np.array(STILL_AIR)).all()


def test_the_mean_wind_comes_from_the_given_direction() -> None:
    wind = WindClass("test", 10.0)
    gusts = [blow(wind, seed=seed, periods=1, direction=pi / 3)[0, :2] for seed in range(400)]
    mean = wind.mean_wind(30.0)
    # Four standard errors of the mean gust.
    error = 4.0 * dryden(10.0, height=30.0, span=3.0).sigma_horizontal / sqrt(len(gusts))
    np.testing.assert_allclose(np.mean(gusts, axis=0), [-mean * cos(pi / 3), -mean * sin(pi / 3)], atol=error)


def test_the_mean_wind_follows_the_profile_of_the_standard() -> None:
    # MIL-F-8785C, 3.7.3.2: ln(h / 0.15 ft) over ln(20 ft / 0.15 ft).
    wind = WindClass("test", 20.0 * FOOT)
    assert wind.mean_wind(20.0 * FOOT) == pytest.approx(20.0 * FOOT)
    assert wind.mean_wind(30.0) == pytest.approx(8.08, abs=0.005)
    assert (
        wind.mean_wind(0.0)
        == wind.mean_wind(3.0 * FOOT)
        == pytest.approx(6.096 * np.log(20) / np.log(400 / 3))
    )


def blown_at(height: float) -> Wind:
    """Returns the first wind at a true height, of one seed."""
    source = DrydenWind(
        wind_class("light"), height=30.0, span=3.0, direction=0.0, step=0.01, rng=np.random.default_rng(1)
    )
    source.signals.truth[2] = -height
    source.run()
    return Wind._make(source.signals.wind.tolist())


def test_mean_wind_and_intensity_follow_the_vehicles_true_height() -> None:
    def expected(height: float) -> tuple[float, float]:
        model = dryden(wind_class("light").wind_at_20_ft, height=height, span=3.0)
        return wind_class("light").mean_wind(height), model.sigma_horizontal

    low, high = blown_at(10.0), blown_at(100.0)
    (mean_low, sigma_low), (mean_high, sigma_high) = expected(10.0), expected(100.0)
    # The unit gust is the same at both heights, but for a step of 10 ms.
    assert (low.north + mean_low) / sigma_low == pytest.approx(
        (high.north + mean_high) / sigma_high, abs=0.05
    )
    assert sigma_low > 1.3 * sigma_high


def test_turning_the_world_turns_the_wind() -> None:
    def source(direction: float) -> DrydenWind:
        rng = np.random.default_rng(7)
        return DrydenWind(wind_class("gtmax"), height=30.0, span=3.0, direction=direction, step=0.01, rng=rng)

    turned, plain = source(0.2), source(0.0)
    plain.rotate_world(0.2)
    for _ in range(50):
        a = turned.step(velocity_north=0.0, velocity_east=0.0)
        assert plain.step(velocity_north=0.0, velocity_east=0.0) == pytest.approx(a, abs=1e-12)


def test_one_seed_gives_one_wind() -> None:
    a, b, other = (blow(wind_class("gtmax"), seed=seed, periods=600, direction=None) for seed in (5, 5, 6))
    assert a.tobytes() == b.tobytes()
    assert a.tobytes() != other.tobytes()


def test_classes_of_the_standard_keep_their_wind_at_20_ft() -> None:
    knots = [WIND_CLASSES[name].wind_at_20_ft * 3600.0 / 1852.0 for name in ("light", "moderate", "severe")]
    assert knots == pytest.approx([15.0, 30.0, 45.0])


def test_a_number_is_a_wind_at_20_ft() -> None:
    assert wind_class("4.5").wind_at_20_ft == 4.5
    for words in ("-1", "nan", "inf"):
        with pytest.raises(UnknownWindError):
            wind_class(words)


def test_the_air_is_stated_at_its_height() -> None:
    assert state_wind("calm", height=30.0) == "still air"
    assert state_wind("light", height=30.0) == (
        "wind at 20 ft 7.72 m/s, at 30 m mean 10.23 m/s, gusts 1.33 m/s (13.0%) horizontal, "
        "0.77 m/s (7.5%) vertical"
    )


def test_a_wind_beyond_the_vehicle_is_refused_in_one_line() -> None:
    library = find_library("thesis-gtmax")
    for wind in ("calm", "gtmax", "light"):
        check_flyable(wind, library, height=30.0)
    for wind in ("moderate", "severe"):
        with pytest.raises(
            UnflyableWindError, match=f"wind {wind} cannot be flown: expected at most 22.5 m/s"
        ):
            check_flyable(wind, library, height=30.0)


def test_a_vehicle_with_less_cyclic_holds_less_wind() -> None:
    vehicle = read_parameters()
    weak = replace(vehicle, servos=replace(vehicle.servos, pedal_high=0.25))
    assert held_airspeed(weak) < 0.75 * held_airspeed(vehicle)


@pytest.mark.parametrize("course", COURSES)
def test_gusts_are_the_standards_along_the_motion_through_the_air(course: str) -> None:
    flight = fly_course(course)
    for ratio in spectrum_ratios(flight).values():
        assert SPECTRUM_LIMITS[0] < ratio < SPECTRUM_LIMITS[1]
    for slope in rate_slopes(flight).values():
        assert RATE_LIMITS[0] < slope < RATE_LIMITS[1]


def test_axes_along_the_mean_wind_would_be_found() -> None:
    """Negative control: axes along the mean wind are wrong off it."""
    across = spectrum_ratios(fly_course("crosswind"), axis=0.0)
    assert across["along-track"] > 1.2
    assert across["cross-track"] < 0.85
    for slope in rate_slopes(fly_course("downwind"), axis=0.0).values():
        assert slope == pytest.approx(-1.0, abs=0.01)


def test_gusts_do_not_turn_with_the_vehicle() -> None:
    """A turn of the axes leaves the gust where it was in the world."""
    source = DrydenWind(
        wind_class("gtmax"), height=30.0, span=3.0, direction=0.0, step=1e-6, rng=np.random.default_rng(3)
    )
    blown = np.array(
        [
            source.step(velocity_north=20.0 * cos(angle), velocity_east=20.0 * sin(angle))
            for angle in np.linspace(0.0, 2.0 * pi, 50)
        ]
    )
    np.testing.assert_allclose(blown[:, :3], np.broadcast_to(blown[0, :3], (50, 3)), atol=0.03)


def test_gusts_keep_their_strength_in_a_turn() -> None:
    """Turning axes leave the gusts stationary: two full turns at 0.6 rad/s."""
    model, last = dryden(6.096, height=30.0, span=3.0), []
    for seed in range(800):
        source = DrydenWind(
            wind_class("6.096"),
            height=30.0,
            span=3.0,
            direction=0.0,
            step=1.0,
            rng=np.random.default_rng(seed),
        )
        for second in range(21):
            angle = 0.6 * second
            wind = source.step(velocity_north=10.0 * cos(angle), velocity_east=10.0 * sin(angle))
        last.append(wind[:3])
    sigmas = (model.sigma_horizontal, model.sigma_horizontal, model.sigma_vertical)
    # Four standard errors of a standard deviation from 800 samples.
    np.testing.assert_allclose(np.std(last, axis=0), sigmas, rtol=4.0 / sqrt(1600))


def test_an_unknown_wind_class_is_refused_with_the_known_ones() -> None:
    with pytest.raises(UnknownWindError, match=r"no wind class 'breeze'; there are \['calm', 'gtmax'"):
        wind_class("breeze")


def test_still_air_is_no_wind() -> None:
    assert Wind(0.0, 0.0, 0.0, 0.0, 0.0, 0.0) == STILL_AIR


def test_a_discrete_gust_comes_and_goes_as_a_cosine() -> None:
    gust = DiscreteGust(start=2.0, duration=4.0, north=3.0, east=-1.0, down=0.5)

    def blown(time: float) -> list[float]:
        wind = np.zeros(6)
        gust.blow(wind, time)
        return list(wind)

    assert blown(1.9) == blown(6.1) == list(STILL_AIR)
    assert blown(4.0) == pytest.approx([3.0, -1.0, 0.5, 0.0, 0.0, 0.0])
    assert blown(3.0)[0] == pytest.approx(1.5)
    with pytest.raises(ValueError, match="duration must be > 0 s, got 0"):
        DiscreteGust(start=0.0, duration=0.0, north=1.0, east=0.0, down=0.0)


@pytest.mark.parametrize("ratio", RATIOS)
def test_the_covariance_of_the_discrete_filter_is_that_of_the_standard(ratio: float) -> None:
    assert lateral_variance(ratio) == pytest.approx(1.0, abs=FIXED_POINT_LIMIT)


def test_ensembles_and_spectra_are_the_standards() -> None:
    assert [figure for figure in check_wind() if not figure.passed] == []


def test_an_euler_step_would_be_found() -> None:
    """Negative control: Euler's step gives too strong a gust."""
    tau, step = 0.5, 0.01
    ratio = step / tau
    variance = 2.0 * ratio / (1.0 - (1.0 - ratio) ** 2)
    assert abs(variance - 1.0) > 1e6 * FIXED_POINT_LIMIT
