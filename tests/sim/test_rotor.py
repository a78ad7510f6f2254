"""Tests of the rotor's loads by steady flight and small motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flight.se2 import Twist
from sim.vehicle.equilibrium import RESIDUAL, EquilibriumFinder, NoEquilibriumError
from sim.vehicle.linearisation import state_matrix
from sim.vehicle.parameters import read_parameters

PARAMETERS = read_parameters()
FINDER = EquilibriumFinder(PARAMETERS)
FOOT = 0.3048


@settings(deadline=None)
@given(forward=st.floats(0.0, 6.0), yaw_rate=st.floats(-0.7, 0.7))
def test_every_trim_of_the_slow_range_has_an_equilibrium(forward: float, yaw_rate: float) -> None:
    found = FINDER.find(Twist(forward, 0.0, yaw_rate))
    residual, _ = FINDER.residual(found)
    assert residual <= RESIDUAL


def test_a_turn_banks_into_the_turn() -> None:
    left, straight, right = (FINDER.find(Twist(3.0, 0.0, rate)).roll for rate in (-0.6, 0.0, 0.6))
    # The bank of straight flight balances the tail rotor.
    bank = np.arctan(3.0 * 0.6 / PARAMETERS.environment.gravity)
    assert right - straight == pytest.approx(bank, abs=0.01)
    assert left - straight == pytest.approx(-bank, abs=0.01)


def test_hover_needs_about_seven_kilowatts() -> None:
    hover = FINDER.find(Twist(0.0, 0.0, 0.0))
    assert hover.power == pytest.approx(7.4e3, rel=0.05)
    # Momentum theory: weight times induced velocity is the least that a rotor can do.
    assert hover.power > PARAMETERS.body.mass * PARAMETERS.environment.gravity * hover.rotor_state[8]


def test_power_has_a_bucket_over_speed() -> None:
    hover, cruise, fast = (FINDER.find(Twist(v * FOOT, 0.0, 0.0)).power for v in (0.0, 40.0, 80.0))
    assert cruise < 0.8 * hover
    assert cruise < 0.85 * fast
    assert fast < 15e3


def test_a_velocity_beyond_the_envelope_is_refused_with_its_numbers() -> None:
    with pytest.raises(NoEquilibriumError, match=r"forward 60 m/s.*beyond its travel"):
        FINDER.find(Twist(60.0, 0.0, 0.0))


def test_hover_moves_like_the_identified_r50() -> None:
    modes = np.linalg.eigvals(state_matrix(PARAMETERS, FINDER.find(Twist(0.0, 0.0, 0.0))))
    # Mettler, Tischler, Kanade 2000: flapping, roll, pitch.
    for identified in (-20.3 + 4.7j, -2.67 + 11.5j, -1.70 + 8.19j):
        nearest = modes[np.argmin(np.abs(modes - identified))]
        assert abs(nearest) == pytest.approx(abs(identified), rel=0.10)
        assert nearest.real == pytest.approx(identified.real, rel=0.10)
    heave = modes[np.argmin(np.abs(modes + 0.5))]
    assert heave.real == pytest.approx(-0.61, rel=0.30)


def test_without_its_hub_spring_it_no_longer_moves_like_the_r50() -> None:
    from dataclasses import replace

    limp = replace(PARAMETERS, main_rotor=replace(PARAMETERS.main_rotor, hub_spring=1e-6))
    modes = np.linalg.eigvals(state_matrix(limp, EquilibriumFinder(limp).find(Twist(0.0, 0.0, 0.0))))
    assert np.min(np.abs(modes - (-2.67 + 11.5j))) > 1.15
