"""Tests of affine arithmetic: enclosure of all symbol values."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.independent_errors.affine import AffineForm, AffinePoint, affine_coast

SYMBOLS, DRAWS = 5, 400

Made = tuple[AffineForm, Callable[[np.ndarray], np.ndarray]]
"""A number, and its true value for symbols of shape (draws, symbols)."""


def number(rng: np.random.Generator, middle: float, spread: float) -> Made:
    slope = rng.normal(size=(1, SYMBOLS)) * spread / SYMBOLS
    return AffineForm.exact(np.array([middle]), slope), lambda d: middle + d @ slope[0]


def drawn(rng: np.random.Generator) -> np.ndarray:
    draws = rng.uniform(-1, 1, (DRAWS, SYMBOLS))
    draws[: DRAWS // 2] = np.sign(draws[: DRAWS // 2])
    return draws


def holds(made: AffineForm, true: np.ndarray, draws: np.ndarray) -> None:
    if np.isinf(made.radius[0]):
        return
    apart = np.abs(true - made.middle[0] - draws @ made.slope[0])
    assert apart.max() <= made.radius[0] + 1e-12 * (1 + np.abs(true).max())


seeds = st.integers(0, 2**32 - 1)
spreads = st.sampled_from([1e-6, 0.01, 0.1, 0.5, 1.0, 3.0])


@given(seeds, spreads)
@settings(max_examples=200, deadline=None)
def test_numbers_keep_to_their_radius(seed: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    draws = drawn(rng)
    a, true_a = number(rng, rng.normal(), spread)
    b, true_b = number(rng, rng.choice([-1, 1]) * rng.uniform(0.5, 4), spread)
    product = a * b
    holds(product, true_a(draws) * true_b(draws), draws)
    holds(product * product - a, (true_a(draws) * true_b(draws)) ** 2 - true_a(draws), draws)
    holds(b.inverse(), 1 / true_b(draws), draws)
    holds((product * b.inverse()).scaled(-2.0).shifted(1.0), 1 - 2 * true_a(draws), draws)
    holds(a.sinc(), np.sinc(true_a(draws) / np.pi), draws)
    with np.errstate(invalid="ignore"):
        holds(b.root(), np.sqrt(true_b(draws)), draws)


@given(seeds, spreads)
@settings(max_examples=200, deadline=None)
def test_points_keep_to_their_radius(seed: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    draws = drawn(rng)
    (x, true_x), (y, true_y) = (number(rng, rng.normal() * 3, spread) for _ in range(2))
    angle, true_angle = number(rng, rng.uniform(-4, 4), spread)
    point, true = AffinePoint(x, y), true_x(draws) + 1j * true_y(draws)
    turned, true_turned = point.rotated(angle), true * np.exp(1j * true_angle(draws))
    holds(turned.x, true_turned.real, draws)
    holds(turned.y, true_turned.imag, draws)
    holds(turned.distance(), np.abs(true), draws)
    bearing = turned.bearing()
    near = bearing.middle[0] + draws @ bearing.slope[0]
    holds(bearing, near + np.angle(true_turned * np.exp(-1j * near)), draws)
    holds(point.rotated_left().x, (-1j * true).real, draws)


@given(seeds, st.sampled_from([1e-3, 0.1, 0.5]))
@settings(max_examples=100, deadline=None)
def test_coasts_keep_to_their_radius(seed: int, spread: float) -> None:
    rng = np.random.default_rng(seed)
    draws = drawn(rng)
    (x, true_x), (y, true_y) = (number(rng, rng.normal() * 3, spread) for _ in range(2))
    rate, true_rate = number(rng, rng.choice([0.0, 1e-12, 0.6, -0.3]), 0.1 * spread)
    time, true_time = number(rng, rng.uniform(0, 8), spread)
    moved, turned = affine_coast(AffinePoint(x, y), rate, time)
    angle = true_rate(draws) * true_time(draws)
    chord = np.sinc(angle / (2 * np.pi)) * np.exp(0.5j * angle)
    true = (true_x(draws) + 1j * true_y(draws)) * true_time(draws) * chord
    holds(turned, angle, draws)
    holds(moved.x, true.real, draws)
    holds(moved.y, true.imag, draws)


def test_what_a_product_leaves_out_shrinks_with_the_square_of_the_box() -> None:
    rng = np.random.default_rng(3)
    sizes = np.array([0.4, 0.2, 0.1, 0.05])
    radii = []
    for size in sizes:
        rng = np.random.default_rng(3)
        (x, _), (y, _), (angle, _) = (number(rng, 2.0, size) for _ in range(3))
        radii.append(float(AffinePoint(x, y).rotated(angle).distance().radius[0]))
    assert np.polyfit(np.log(sizes), np.log(radii), 1)[0] == pytest.approx(2.0, abs=0.2)


def test_where_an_operation_is_not_defined_nothing_is_claimed() -> None:
    rng = np.random.default_rng(1)
    wide, _ = number(rng, 0.5, 20.0)
    with np.errstate(all="ignore"):
        assert np.isinf(wide.inverse().radius[0])
        assert np.isinf(wide.root().radius[0])
        assert np.isinf(AffinePoint(wide, wide).bearing().radius[0])
        assert np.isfinite(AffinePoint(wide, wide).distance().radius[0])
