"""Digits of identified numbers: six significant ones, the same on every processor.

The thirteenth digit of a mean depends on the order in which a processor adds; six are more than flights
determine.
"""

from collections.abc import Iterable
from math import ceil, floor, log10

from flight.automaton.joint_law import Row3, Row4

DIGITS = 6
# Smaller numbers are rounding errors of zeros; relative differences below are those of processors.
_ZERO, _SAME = 1e-9, 1e-9


def rounded(value: float) -> float:
    """Returns a number with six significant digits."""
    return float(f"{value:.{DIGITS}g}") + 0.0 if abs(value) > _ZERO else 0.0


def rounded_up(value: float) -> float:
    """Returns a positive number rounded up to six digits.

    What is such a number but for a processor's last bits becomes the next one, so that it is a bound on all.
    """
    if value <= _ZERO:
        return 2 * _ZERO if value > 0 else 0.0
    above = value * (1 + _SAME)
    unit = 10.0 ** (floor(log10(above)) - DIGITS + 1)
    return rounded(ceil(above / unit) * unit)


def rounded_down(value: float) -> float:
    """Returns a positive number rounded down to six digits."""
    if value <= _ZERO:
        return 0.0
    below = value * (1 - _SAME)
    unit = 10.0 ** (floor(log10(below)) - DIGITS + 1)
    return rounded(floor(below / unit) * unit)


def row3(values: Iterable[float]) -> Row3:
    """Returns three numbers with six significant digits."""
    first, second, third = (rounded(float(value)) for value in values)
    return first, second, third


def row4(values: Iterable[float]) -> Row4:
    """Returns four numbers with six significant digits."""
    first, second, third, fourth = (rounded(float(value)) for value in values)
    return first, second, third, fourth


def matrix3(rows: Iterable[Iterable[float]]) -> tuple[Row3, Row3, Row3]:
    """Returns a matrix with six significant digits."""
    first, second, third = map(row3, rows)
    return first, second, third


def matrix4(rows: Iterable[Iterable[float]]) -> tuple[Row4, Row4, Row4, Row4]:
    """Returns a matrix with six significant digits."""
    first, second, third, fourth = map(row4, rows)
    return first, second, third, fourth
