"""Tests of the controller in still air with ideal sensors (thesis, 2.6.2)."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from flight.se2 import Twist
from sim.checks import controller_check
from sim.checks.controller_check import check_adaptation, check_margins, flown_delay_margin
from sim.checks.margins import read_margins
from sim.checks.response_check import settling_time
from sim.checks.velocity_response import Response, simulate_response
from sim.control.controller import Controller
from sim.control.gains import Gains
from sim.control.maneuver_generator import ManeuverGenerator
from sim.loop.motion import Motion
from sim.vehicle.parameters import change_vehicle, read_parameters

PARAMETERS = read_parameters()
FOOT = 0.3048


def change(start: Twist, end: Twist, *, gains: Gains | None = None, adaptive: bool = True) -> Response:
    return simulate_response([(start, 0.01), (end, 12.0)], vehicle=PARAMETERS, gains=gains, adaptive=adaptive)


@pytest.mark.parametrize(("start", "end"), [(0, 3), (3, 10), (0, 10), (10, 0), (10, 3)])
def test_speed_changes_settle_in_the_same_time(start: float, end: float) -> None:
    flown = change(Twist(start * FOOT, 0.0, 0.0), Twist(end * FOOT, 0.0, 0.0))
    forward = flown.column("forward")
    assert settling_time(forward, start=start * FOOT, end=end * FOOT) == pytest.approx(4.2, rel=0.10)
    assert np.abs(forward - flown.reference[:, 0]).max() < 0.02 * abs(end - start) * FOOT
    assert np.abs(flown.column("side")).max() < 0.03
    assert np.abs(flown.column("down") + 30.0).max() < 0.1


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.6), (0.6, 0.0), (0.0, -0.6), (0.6, -0.6)])
def test_turns_settle_in_the_same_time_without_slipping(start: float, end: float) -> None:
    flown = change(Twist(10.0 * FOOT, 0.0, start), Twist(10.0 * FOOT, 0.0, end))
    assert settling_time(flown.column("yaw_rate"), start=start, end=end) == pytest.approx(3.2, rel=0.10)
    assert np.abs(flown.column("side")).max() < 0.08
    assert np.abs(flown.column("forward") - 10.0 * FOOT).max() < 0.05


def test_without_running_ahead_the_turn_slips() -> None:
    """Negative control of the feed-forward."""
    start, end = Twist(10.0 * FOOT, 0.0, 0.0), Twist(10.0 * FOOT, 0.0, 0.6)
    assert np.abs(change(start, end, gains=replace(Gains(), lead=-0.2)).column("side")).max() > 0.1


def test_every_margin_holds_at_every_trim_and_mass() -> None:
    assert [figure for figure in check_margins(PARAMETERS) if not figure.passed] == []


@pytest.mark.parametrize(
    ("gains", "extra_delay"), [(replace(Gains(), attitude=(8.0, 7.0)), 0.02), (Gains(), 0.5)]
)
def test_margins_are_missed_by_gains_too_high_or_delay_too_long(gains: Gains, extra_delay: float) -> None:
    """Negative control of the margins."""
    figures = list(check_margins(PARAMETERS, gains=gains, extra_delay=extra_delay))
    assert not all(figure.passed for figure in figures)


def nudged(velocity: Twist, *, gains: Gains | None = None, adaptive: bool = True) -> Response:
    """Flies 30 s after a second at another velocity.

    That is 1 m/s slower, with 0.5 m/s sideways and 0.1 rad/s.
    """
    nudge = Twist(velocity.forward - 1.0, 0.5, 0.1)
    return simulate_response(
        [(nudge, 1.0), (velocity, 30.0)], vehicle=PARAMETERS, gains=gains, adaptive=adaptive
    )


def swing(flown: Response, name: str) -> float:
    """Returns an angle's peak-to-peak in the last 5 s, degrees."""
    return float(np.degrees(np.ptp(flown.column(name)[-500:])))


# Banking without lag for the whole yaw rate.
AT_ONCE = replace(Gains(), turn_time=1e-6)


@pytest.mark.parametrize("adaptive", [True, False])
@pytest.mark.parametrize("speed", range(0, 81, 8))
def test_in_straight_flight_up_to_80_ft_s_nose_and_wings_come_to_rest(speed: float, adaptive: bool) -> None:
    flown = nudged(Twist(speed * FOOT, 0.0, 0.0), adaptive=adaptive)
    assert max(swing(flown, name) for name in ("roll", "pitch", "heading")) < 0.02
    assert np.abs(flown.column("roll_rate")[-500:]).max() < 1e-4
    assert abs(flown.column("forward")[-1] - speed * FOOT) < 0.1


@pytest.mark.parametrize("adaptive", [True, False])
@pytest.mark.parametrize("speed", [56, 64, 72, 80])
def test_banking_at_once_for_a_swing_of_the_tail_keeps_it_swinging(speed: float, adaptive: bool) -> None:
    """Negative control: banking without the lag of the turn."""
    flown = nudged(Twist(speed * FOOT, 0.0, 0.0), gains=AT_ONCE, adaptive=adaptive)
    assert swing(flown, "roll") > 5.0
    assert swing(flown, "pitch") > 0.5


def test_banking_at_once_has_its_margins_at_the_slow_trims_only() -> None:
    missed = {figure.name for figure in check_margins(PARAMETERS, gains=AT_ONCE) if not figure.passed}
    assert "fast, gain at lateral" in missed
    assert "fast, share of stable loops" in missed
    assert all(name.startswith("fast, ") for name in missed)


@pytest.mark.parametrize(("gains", "calm"), [(Gains(), True), (AT_ONCE, False)])
def test_fast_flight_in_turbulence_does_not_change_the_hover_after_it(gains: Gains, calm: bool) -> None:
    speeds = (0, 16, 32, 48, 64, 80, 64, 48, 32, 16, 0)
    legs = [(Twist(speed * FOOT, 0.0, 0.0), 8.0) for speed in speeds]
    flown = simulate_response(legs, vehicle=PARAMETERS, gains=gains, wind="gtmax")
    before, after = (
        np.abs(flown.column("pitch_rate")[place]).max() for place in (slice(800), slice(-200, None))
    )
    assert bool(after < 2.0 * before) == calm


def test_margins_of_a_known_loop_are_read_right() -> None:
    # 2 / (s (s + 1)^2): phase -180 deg at 1 rad/s, where the gain is 1; half of it has 6 dB.
    frequencies = np.geomspace(0.01, 100.0, 20_000)
    s = 1j * frequencies
    assert read_margins(frequencies, 1.0 / (s * (s + 1.0) ** 2)).gain == pytest.approx(6.02, abs=0.01)
    # 1 / (s (s + 1)): crosses at 0.786 rad/s with 51.8 deg, so 1.15 s of delay.
    read = read_margins(frequencies, 1.0 / (s * (s + 1.0)))
    assert read.phase == pytest.approx(51.83, abs=0.05)
    assert read.delay == pytest.approx(1.15, abs=0.005)
    assert read.crossover == pytest.approx(0.786, abs=0.001)


def test_the_computed_delay_margin_is_the_flown_one() -> None:
    figures = list(controller_check.check_delay(PARAMETERS))
    assert [figure for figure in figures if not figure.passed] == []


def test_the_adaptive_element_halves_the_error_of_a_changed_vehicle_and_harms_none() -> None:
    figures = list(check_adaptation(PARAMETERS))
    assert len(figures) == 5
    assert [figure for figure in figures if not figure.passed] == []


def test_without_the_element_a_shifted_centre_stays_an_error() -> None:
    shifted = change_vehicle(PARAMETERS, hub_forward=0.03)
    flown = simulate_response(
        [(Twist(0.0, 0.0, 0.0), 20.0)],
        vehicle=shifted,
        controller_model=PARAMETERS,
        adaptive=False,
        skip=1500,
    )
    assert flown.velocity_error > 0.5


def test_the_halved_error_is_missed_by_an_element_that_does_not_learn() -> None:
    """Negative control of the adaptation: mass +20 %, learning rates 0."""
    blunt = Gains(learning_velocity=0.0, learning_descent=0.0, learning_attitude=0.0, learning_yaw=0.0)
    nominal, heavy = islice(check_adaptation(PARAMETERS, gains=blunt), 2)
    assert nominal.value == heavy.value == 1.0
    assert not heavy.passed


def test_twice_the_delay_margin_is_unstable() -> None:
    """Negative control of the delay margin."""
    margin = flown_delay_margin(PARAMETERS, adaptive=True)
    nudged, fast = Twist(3.148, 0.1, 0.02), Twist(3.048, 0.0, 0.0)
    late = change_vehicle(PARAMETERS, extra_delay=2.0 * margin)
    flown = simulate_response([(nudged, 1.0), (fast, 29.0)], vehicle=late)
    assert flown.lost or np.abs(flown.column("pitch_rate")[-500:]).max() > 0.3


def test_the_element_does_not_learn_the_servos_limits() -> None:
    """Negative control of hedging: slow servos spoil the weights without it."""
    servos = replace(PARAMETERS.servos, rate=0.06, cyclic_limit=0.06)
    lame = replace(PARAMETERS, servos=servos)
    learnt = []
    for hedging in (1.0, 0.0):
        flown = simulate_response(
            [(Twist(0.0, 0.0, 0.0), 5.0), (Twist(15.0, 0.0, 0.0), 6.0)],
            vehicle=lame,
            gains=replace(Gains(), hedging=hedging, learning_attitude=60.0),
        )
        learnt.append(np.abs(flown.controller.state[-18:]).max())
    assert learnt[0] < 0.8 * learnt[1]


def test_turning_the_world_turns_what_was_learnt_of_the_wind() -> None:
    flown = simulate_response([(Twist(0.0, 0.0, 0.0), 20.0)], vehicle=PARAMETERS, wind="gtmax")
    controller, motion = flown.controller, Motion._make(flown.motion[-1])
    reference = ManeuverGenerator(Twist(0.0, 0.0, 0.0), step=0.01).step(Twist(0.0, 0.0, 0.0))
    other = Controller(PARAMETERS, height=30.0, step=0.01)
    other.restore(controller.state)
    controller.rotate_world(0.7)
    turned = motion._replace(heading=motion.heading + 0.7)
    assert controller.step(turned, reference) == pytest.approx(other.step(motion, reference), abs=1e-12)


def test_a_gain_too_high_for_servo_and_rotor_is_seen() -> None:
    calm, wild = (
        change(Twist(3.0, 0.0, 0.0), Twist(3.0, 0.0, 0.1), gains=gains)
        for gains in (Gains(), replace(Gains(), attitude=(12.0, 12.0)))
    )
    assert (
        wild.lost
        or np.abs(wild.column("roll_rate")[300:]).max() > 10.0 * np.abs(calm.column("roll_rate")[300:]).max()
    )
