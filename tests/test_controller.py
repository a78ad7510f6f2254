"""The controller in still air with ideal sensors: responses as in the thesis, section 2.6.2."""

from dataclasses import replace

import numpy as np
import pytest

from flight.se2 import Twist
from sim.controller import Controller, Gains
from sim.equilibrium import EquilibriumFinder
from sim.helicopter import Helicopter
from sim.maneuver_generator import ManeuverGenerator
from sim.motion import STILL_AIR, Motion
from sim.parameters import Parameters, read_parameters

PARAMETERS = read_parameters()
FOOT = 0.3048
STEP = 0.01


def respond(
    start: Twist,
    end: Twist,
    *,
    seconds: float = 12.0,
    gains: Gains | None = None,
    vehicle: Parameters = PARAMETERS,
) -> tuple[np.ndarray, np.ndarray]:
    """Returns motion and reference velocity at 100 Hz after a change of trim."""
    helicopter = Helicopter(vehicle)
    helicopter.place(EquilibriumFinder(vehicle).find(start), altitude=30.0, heading=1.0)
    controller = Controller(PARAMETERS, height=30.0, step=STEP, gains=gains)
    generator = ManeuverGenerator(start, step=STEP)
    motions, references = [], []
    for _ in range(round(seconds / STEP)):
        motion = helicopter.motion()
        reference = generator.step(end)
        motions.append(motion)
        references.append((reference.forward.value, reference.side.value, reference.yaw_rate.value))
        helicopter.advance(controller.step(motion, reference), STILL_AIR, steps=2)
    return np.array(motions), np.array(references)


def column(name: str) -> int:
    return Motion._fields.index(name)


def settling_time(values: np.ndarray, *, start: float, end: float) -> float:
    outside = np.nonzero(np.abs(values - end) > 0.05 * abs(end - start))[0]
    return float(outside[-1] + 1) * STEP


@pytest.mark.parametrize(("start", "end"), [(0, 3), (3, 10), (0, 10), (10, 0), (10, 3)])
def test_speed_changes_settle_in_the_same_time(start: float, end: float) -> None:
    motions, references = respond(Twist(start * FOOT, 0.0, 0.0), Twist(end * FOOT, 0.0, 0.0))
    forward = motions[:, column("forward")]
    assert settling_time(forward, start=start * FOOT, end=end * FOOT) == pytest.approx(4.2, rel=0.10)
    assert np.abs(forward - references[:, 0]).max() < 0.02 * abs(end - start) * FOOT
    assert np.abs(motions[:, column("side")]).max() < 0.03
    assert np.abs(motions[:, column("down")] + 30.0).max() < 0.1


@pytest.mark.parametrize(("start", "end"), [(0.0, 0.6), (0.6, 0.0), (0.0, -0.6), (0.6, -0.6)])
def test_turns_settle_in_the_same_time_without_slipping(start: float, end: float) -> None:
    motions, _ = respond(Twist(10.0 * FOOT, 0.0, start), Twist(10.0 * FOOT, 0.0, end))
    yaw_rate = motions[:, column("yaw_rate")]
    assert settling_time(yaw_rate, start=start, end=end) == pytest.approx(3.2, rel=0.10)
    assert np.abs(motions[:, column("side")]).max() < 0.05
    assert np.abs(motions[:, column("forward")] - 10.0 * FOOT).max() < 0.05


def test_without_feed_forward_of_the_bar_the_turn_slips() -> None:
    motions, _ = respond(
        Twist(10.0 * FOOT, 0.0, 0.0), Twist(10.0 * FOOT, 0.0, 0.6), gains=replace(Gains(), rate_ahead=0.0)
    )
    assert np.abs(motions[:, column("side")]).max() > 0.1


def test_a_heavier_vehicle_still_settles() -> None:
    heavy = replace(PARAMETERS, body=replace(PARAMETERS.body, mass=1.2 * PARAMETERS.body.mass))
    motions, _ = respond(Twist(0.0, 0.0, 0.0), Twist(10.0 * FOOT, 0.0, 0.0), seconds=20.0, vehicle=heavy)
    assert motions[-1, column("forward")] == pytest.approx(10.0 * FOOT, abs=0.05)
    assert motions[-1, column("down")] == pytest.approx(-30.0, abs=0.3)


def test_a_gain_too_high_for_servo_and_rotor_is_seen() -> None:
    calm, _ = respond(Twist(3.0, 0.0, 0.0), Twist(3.0, 0.0, 0.1), seconds=6.0)
    wild, _ = respond(
        Twist(3.0, 0.0, 0.0), Twist(3.0, 0.0, 0.1), seconds=6.0, gains=replace(Gains(), attitude=2.0)
    )
    rates = column("roll_rate")
    assert np.abs(wild[300:, rates]).max() > 10.0 * np.abs(calm[300:, rates]).max()
