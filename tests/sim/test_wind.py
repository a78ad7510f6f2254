"""Tests of the wind: Dryden statistics, calm air and seeds."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from sim.checks.wind_check import FIXED_POINT_LIMIT, RATIOS, check_wind, lateral_variance
from sim.loop.motion import STILL_AIR, Wind
from sim.wind.discrete_gust import DiscreteGust
from sim.wind.dryden import dryden
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
    np.testing.assert_allclose(last[:, :3].mean(axis=0), 0.0, atol=4 * model.sigma_horizontal / sqrt(2000))


def test_gusts_along_the_wind_forget_exponentially() -> None:
    series = blow(WindClass("test", 10.0), seed=3, periods=200_000, step=0.5)[:, 0]
    model = dryden(10.0, height=30.0, span=3.0)
    lag = round(model.length_horizontal / 4.0 / 0.5)
    correlation = np.mean(series[:-lag] * series[lag:]) / series.var()
    assert correlation == pytest.approx(np.exp(-1.0), abs=0.05)


def test_calm_is_still_air() -> None:
    assert (blow(wind_class("calm"), seed=1, periods=100) == np.array(STILL_AIR)).all()


def test_the_mean_wind_comes_from_the_given_direction() -> None:
    mean = blow(WindClass("test", 0.0, 2.0), seed=1, periods=1, direction=pi / 3)[0]
    np.testing.assert_allclose(mean[:2], [-2.0 * cos(pi / 3), -2.0 * sin(pi / 3)])


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


def test_stronger_classes_blow_harder() -> None:
    order = [WIND_CLASSES[name] for name in ("calm", "gtmax", "light", "moderate", "severe")]
    assert order == sorted(order, key=lambda wind: (wind.wind_at_20_ft, wind.mean_wind))
    assert wind_class("gtmax").wind_at_20_ft == pytest.approx(6.096)


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
