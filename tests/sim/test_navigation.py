"""Tests of the navigation filter: consistency, gates and loss of GPS."""

from collections.abc import Iterator
from concurrent.futures import Executor
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from experiments.campaign.fly_campaign import campaign_library
from flight.mission.fault import parse_fault
from flight.se2 import SE2
from runtime.executor import worker_pool
from scenarios.find import find_campaign
from sim.checks.controller_check import fly_walk
from sim.checks.navigation_check import (
    FilterErrors,
    check_filter_consistency,
    check_gps_outages,
    fly_gps_outages,
    fly_random_walks,
)
from sim.faults.sensor_faults import FaultySensors
from sim.loop.motion import Motion
from sim.loop.signals import Signals
from sim.navigation import filter as equations
from sim.navigation.filter import ESTIMATED
from sim.navigation.installation import Installation
from sim.navigation.navigation import IdealNavigation, Navigation
from sim.navigation.sensor_errors import (
    GaussMarkovError,
    SensorErrors,
    UnknownSensorsError,
    sensor_classes,
    sensor_errors,
)
from sim.vehicle.parameters import read_parameters

PARAMETERS = read_parameters()
LIBRARY = campaign_library(find_campaign("gtmax"), "gtmax")
STILL = Motion(5.0, -3.0, -30.0, 1.0, 0.5, 0.0, 0.05, -0.02, 2.0, 0.0, 0.0, 0.0, 0.0)


def navigate(
    truth: Motion,
    *,
    seed: int = 1,
    errors: SensorErrors | None = None,
    true_errors: SensorErrors | None = None,
) -> Navigation:
    rng = np.random.default_rng(seed)
    return Navigation(truth, step=0.01, gravity=9.81, rng=rng, errors=errors, true_errors=true_errors)


def test_ideal_navigation_estimates_the_truth_without_delay() -> None:
    signals = Signals()
    navigation = IdealNavigation(signals)
    for north in (0.0, 1.0, 2.0):
        signals.truth[:] = STILL._replace(north=north)
        navigation.run()
        assert signals.estimate.tolist() == signals.truth.tolist()


@pytest.fixture(scope="module")
def pool() -> Iterator[Executor]:
    with worker_pool(2) as executor:
        yield executor


@pytest.mark.parametrize("sensors", ["rtk", "gps"])
def test_the_filter_of_a_fleet_knows_its_class_of_sensors(pool: Executor, sensors: str) -> None:
    """The whole check, of fifty flights, is a topic of `maneuver verify`."""
    flights = fly_random_walks(LIBRARY, sensors, flights=12, seconds=100.0, executor=pool)
    figures = list(check_filter_consistency(flights, sensors))
    assert len(figures) == 3
    assert [figure for figure in figures if not figure.passed] == []


def test_the_filter_survives_losing_its_gps(pool: Executor) -> None:
    figures = list(check_gps_outages(fly_gps_outages(LIBRARY, 2.0, executor=pool), "2 s"))
    assert [figure for figure in figures if not figure.passed] == []


def test_a_class_with_noise_alone_has_no_other_error() -> None:
    believed, made = sensor_errors("rtk-noise")
    assert believed == sensor_classes()["rtk"]
    assert {drift.sigma for drift in made.drifts} == {0.0}
    assert made.misalignment == made.gyro_scale == made.heading_deviation == made.vibration == 0.0
    assert made.inertial_noise == believed.inertial_noise
    _, made = sensor_errors("rtk-systematic")
    assert {*made.inertial_noise, *made.fix_noise} == {0.0}
    assert made.drifts == believed.drifts
    with pytest.raises(UnknownSensorsError, match="no sensor class 'loran'; there are"):
        sensor_errors("loran")


def test_the_wander_of_rtk_is_at_most_five_centimetres() -> None:
    assert sensor_classes()["rtk"].position_drift.sigma <= 0.05
    assert sensor_classes()["gps"].position_drift.sigma >= 1.0


def test_installed_sensors_read_what_their_errors_say() -> None:
    """A turn at constant rate: scale, misalignment and deviation by hand."""
    quiet = sensor_classes()["rtk"].only_noise().without_noise()
    scale, tilt, deviation = 0.01, 0.02, 0.03
    built = Installation(
        (0.0, 0.0, scale), (tilt, 0.0, 0.0), (deviation, 0.0, 0.0, 0.0), quiet.antenna, 0.0, 0.0
    )
    navigation = Navigation(
        STILL, step=0.01, gravity=9.81, rng=np.random.default_rng(1), errors=quiet, installation=built
    )
    level = STILL._replace(roll=0.0, pitch=0.0, forward=0.0, side=0.0)
    for period in range(1, 101):
        navigation.signals.truth[:] = level._replace(
            heading=2.0 + 0.005 * period, body_yaw_rate=0.5, yaw_rate=0.5
        )
        navigation.sensors.run()
    rates = navigation.sensors.inertial[3:]
    np.testing.assert_allclose(
        rates, [0.0, 0.5 * np.sin(tilt), 0.5 * np.cos(tilt) * (1.0 + scale)], atol=1e-6
    )
    heading = navigation.sensors.heading_and_height[0]
    assert heading == pytest.approx(2.5 + deviation * np.sin(2.5), abs=1e-9)


def test_a_filter_that_trusts_its_fixes_too_much_is_found() -> None:
    """Negative control: fixes drift ten times more than assumed."""
    truths = [Motion._make(row) for row in fly_walk(PARAMETERS, PARAMETERS, adaptive=True).motion.tolist()]
    rtk = sensor_classes()["rtk"]
    assumed = replace(rtk, position_drift=GaussMarkovError(0.003, 60.0))
    flights = []
    for seed in range(10):
        navigation = navigate(truths[0], seed=seed, errors=assumed, true_errors=rtk)
        normalised, position = [], []
        for period, truth in enumerate(truths[1:6001], start=1):
            navigation.step(truth)
            if period % 2000 == 0:
                normalised.append(navigation.normalised_error(truth))
                position.append(navigation.normalised_position_error(truth))
        flights.append(FilterErrors(np.array(normalised), np.array(position), position=0.0, velocity=0.0))
    position_figure, whole, _ = check_filter_consistency(flights, "rtk")
    assert not position_figure.passed
    assert not whole.passed


def test_twenty_seconds_without_gps_are_too_many(pool: Executor) -> None:
    """Negative control of the loss of GPS."""
    assert not all(
        figure.passed for figure in check_gps_outages(fly_gps_outages(LIBRARY, 20.0, executor=pool), "20 s")
    )


def test_an_outlier_fix_is_rejected() -> None:
    navigation = navigate(STILL)
    sensors = navigation.sensors = FaultySensors(navigation.sensors, step=0.01)
    for period in range(1100):
        if period == 500:
            sensors.begin(1, parse_fault("gps bias 5 inf 50 -50 50"))
        truth = _drift(STILL, period * 0.01)
        estimate = navigation.step(truth)
        assert period < 200 or estimate.pose.distance_to(truth.pose.position) < (0.3 if period < 500 else 1.0)


def test_moving_the_world_moves_the_estimate() -> None:
    navigation, other = navigate(STILL, seed=3), navigate(STILL, seed=3)
    for period in range(800):
        navigation.step(_drift(STILL, period * 0.01))
        other.step(_drift(STILL, period * 0.01))
    displacement = SE2(100.0, 50.0, 0.5)
    now, moved = (_drift(STILL, seconds) for seconds in (7.99, 8.0))
    other.signals.truth[:] = _moved(now, displacement)
    other.move_world(displacement)
    plain, turned = navigation.step(moved), other.step(_moved(moved, displacement))
    expected = displacement @ plain.pose
    assert turned.pose.distance_to(expected.position) < 1e-9
    assert turned.heading == pytest.approx(expected.heading, abs=1e-9)
    assert turned[3:8] == pytest.approx(plain[3:8], abs=1e-9)
    assert other.normalised_error(_moved(moved, displacement)) == pytest.approx(
        navigation.normalised_error(moved), rel=1e-6
    )


def test_one_seed_gives_one_set_of_errors() -> None:
    def last(seed: int) -> Motion:
        navigation = navigate(STILL, seed=seed)
        for period in range(600):
            estimate = navigation.step(_drift(STILL, period * 0.01))
        return estimate

    assert last(4) == last(4)
    assert last(4) != last(5)


def _drift(motion: Motion, seconds: float) -> Motion:
    """Returns a motion continued straight at its heading-frame velocity."""
    pose = motion.pose @ SE2(motion.forward * seconds, motion.side * seconds, 0.0)
    return motion._replace(north=pose.x, east=pose.y)


def _moved(motion: Motion, displacement: SE2) -> Motion:
    pose = displacement @ motion.pose
    return motion._replace(north=pose.x, east=pose.y, heading=pose.heading)


def test_logged_standard_deviations_are_those_of_the_filters_covariance() -> None:
    """Compares first order with 4000 draws in the heading frame."""
    truths = [Motion._make(row) for row in fly_walk(PARAMETERS, PARAMETERS, adaptive=True).motion.tolist()]
    navigation = navigate(truths[0])
    for truth in truths[1:1500]:
        navigation.step(truth)
    nominal = navigation._state[: equations.NOMINAL]
    covariance = navigation._claimed_covariance()
    errors = np.random.default_rng(1).multivariate_normal(np.zeros(ESTIMATED), covariance, 4000)
    disturbed = equations.injection_function().map(4000)(nominal, errors.T)
    state = ca.SX.sym("nominal", equations.NOMINAL)
    estimate = equations.estimated_motion(state, ca.SX.zeros(3), ca.SX(truth.heading))
    drawn = np.array(ca.Function("estimate", [state], [estimate]).map(4000)(disturbed))[: equations.OUTPUTS].T
    np.testing.assert_allclose(navigation.standard_deviation(), drawn.std(axis=0), rtol=0.05)
