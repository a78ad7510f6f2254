"""Tests of the integration step."""

from sim.checks.numerics_check import (
    check_numerics,
    falling_error,
    final_position,
    fitted_order,
    tumbling_error,
)
from sim.vehicle.parameters import read_parameters

PARAMETERS = read_parameters()


def test_the_step_is_fine_enough_and_converges_with_its_order() -> None:
    figures = list(check_numerics(PARAMETERS, displacement_error=0.5))
    assert [figure for figure in figures if not figure.passed] == []
    assert 0.8 < figures[-1].value < 1.3


def test_a_coarse_step_is_found() -> None:
    """Negative control: ten times the step exceeds the limits."""
    assert tumbling_error(PARAMETERS, 0.05) > 0.02
    assert falling_error(PARAMETERS, 0.05) > 0.02


def test_an_order_is_read_from_three_steps() -> None:
    errors = [h**2 - 0.125**2 for h in (1.0, 0.5)]
    assert abs(fitted_order(errors[0], errors[1]) - 2.0) < 0.01


def test_one_step_flies_to_the_same_end_twice() -> None:
    assert (final_position(PARAMETERS, 0.01) == final_position(PARAMETERS, 0.01)).all()
