"""Digits of identified numbers: six, rounded to the safe side, stable in the last bits."""

from math import nextafter

import pytest
from hypothesis import given
from hypothesis import strategies as st

from identification.statistics.digits import rounded, rounded_down, rounded_up

numbers = st.floats(1e-6, 1e6)


@given(numbers)
def test_rounding_has_six_digits_and_is_safe(value: float) -> None:
    assert rounded_down(value) <= value <= rounded_up(value)
    assert rounded_up(value) == pytest.approx(value, rel=3e-5)
    assert rounded_down(value) == pytest.approx(value, rel=3e-5)
    for found in (rounded(value), rounded_up(value), rounded_down(value)):
        assert found == float(f"{found:.6g}")


@given(st.integers(100_000, 999_999), st.integers(-6, 3))
def test_a_number_of_six_digits_and_its_neighbours_round_alike(digits: int, power: int) -> None:
    value = float(f"{digits}e{power}")
    for neighbour in (nextafter(value, 0.0), nextafter(value, 1e9)):
        assert rounded(neighbour) == rounded(value) == value
        assert rounded_up(neighbour) == rounded_up(value) > value
        assert rounded_down(neighbour) == rounded_down(value) < value


def test_rounding_errors_of_zero_are_zero() -> None:
    assert rounded(-3e-17) == 0.0
    assert str(rounded(-3e-17)) == "0.0"
    assert rounded_up(0.0) == 0.0
    assert rounded_up(3e-17) == rounded_up(5e-17) > 5e-17
