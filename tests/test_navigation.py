"""What the vehicle believes: errors of the declared size, old by the declared delay, or none at all."""

import numpy as np
import pytest

from flight.se2 import SE2
from sim.motion import Motion
from sim.navigation import GPS_AIDED, IDEAL, Navigation, NavigationErrors

STILL = Motion(5.0, -3.0, -30.0, 1.0, 0.5, 0.0, 0.05, -0.02, 2.0, 0.0, 0.0, 0.1, 0.1)


def errors(seed: int, *, periods: int, kind: NavigationErrors = GPS_AIDED) -> np.ndarray:
    navigation = Navigation(kind, step=0.01, rng=np.random.default_rng(seed))
    believed: np.ndarray = np.array([navigation.step(STILL) for _ in range(periods)])
    return np.asarray(believed - np.array(STILL))


def test_ideal_navigation_believes_the_truth_at_once() -> None:
    navigation = Navigation(IDEAL, step=0.01, rng=np.random.default_rng(1))
    for north in (0.0, 1.0, 2.0):
        truth = STILL._replace(north=north)
        believed = navigation.step(truth)
        # The rate of the heading, the last, is made of body rates again.
        assert believed[:12] == truth[:12]


def test_errors_have_the_declared_size() -> None:
    last = np.array([errors(seed, periods=4)[-1] for seed in range(400)])
    spread = dict(zip(Motion._fields, last.std(axis=0), strict=True))
    # The standard error of a standard deviation from 400 samples is 3.5 %; four of them.
    position = np.hypot(GPS_AIDED.position_noise, GPS_AIDED.position_wander.sigma)
    assert spread["north"] == pytest.approx(position, rel=0.14)
    assert spread["roll"] == pytest.approx(GPS_AIDED.attitude_wander.sigma, rel=0.14)
    assert spread["heading"] == pytest.approx(GPS_AIDED.heading_wander.sigma, rel=0.14)
    assert spread["roll_rate"] == pytest.approx(
        np.hypot(GPS_AIDED.rate_noise, GPS_AIDED.rate_wander.sigma), rel=0.14
    )
    # A wrong heading turns forward speed into side speed.
    velocity = np.hypot(GPS_AIDED.velocity_noise, GPS_AIDED.velocity_wander.sigma)
    assert spread["side"] == pytest.approx(np.hypot(velocity, GPS_AIDED.heading_wander.sigma), rel=0.14)


def test_the_position_bias_walks_away() -> None:
    ends = np.array([errors(seed, periods=2000)[-1, 0] for seed in range(40)])
    walked = GPS_AIDED.position_walk * np.sqrt(20.0)
    assert ends.std() == pytest.approx(np.hypot(walked, GPS_AIDED.position_wander.sigma), rel=0.4)


def test_the_estimate_is_as_old_as_declared() -> None:
    navigation = Navigation(GPS_AIDED, step=0.01, rng=np.random.default_rng(1))
    for period in range(20):
        believed = navigation.step(STILL._replace(north=1000.0 * period))
    assert believed.north == pytest.approx(1000.0 * (19 - GPS_AIDED.delay_periods), abs=1.0)


def test_moving_the_world_moves_what_was_seen() -> None:
    navigation = Navigation(GPS_AIDED, step=0.01, rng=np.random.default_rng(1))
    navigation.step(STILL)
    displacement = SE2(100.0, 50.0, 0.5)
    moved = displacement @ STILL.pose
    navigation.move(displacement)
    believed = navigation.step(STILL._replace(north=moved.x, east=moved.y, heading=moved.heading))
    assert believed.pose.distance_to(moved.position) < 0.5
    assert believed.heading == pytest.approx(moved.heading, abs=0.1)


def test_one_seed_gives_one_set_of_errors() -> None:
    assert errors(4, periods=600).tobytes() == errors(4, periods=600).tobytes()
    assert errors(4, periods=600).tobytes() != errors(5, periods=600).tobytes()
