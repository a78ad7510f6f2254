"""Dependence on the entry: planted ones are found, absent ones are not."""

from dataclasses import replace

import numpy as np
import pytest

from identification.statistics.entry_model import (
    NO_TERMS,
    Entries,
    EntryTerms,
    choose_terms,
    fit_entries,
    held_out_errors,
)

SHIFT = np.array([0.3, -0.2, 0.1, 0.05])
SLOPE = np.array([[0.0, 0.2, 0.0], [1.5, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
NOISE = np.array([0.05, 0.1, 0.1, 0.02])


def entries(seed: int, *, flights: int = 60, shift: float = 1.0, slope: float = 1.0) -> Entries:
    """Returns planted performances: maneuver 7 shifts, maneuver 8 does not."""
    rng = np.random.default_rng(seed)
    previous = rng.choice([7, 8], flights)
    coast = np.where(rng.uniform(size=flights) < 0.35, 0.0, rng.uniform(0.0, 8.0, flights))
    offset = rng.normal(size=(flights, 3)) * [0.1, 0.1, 0.02]
    values = np.array([4.0, 8.0, 0.0, 0.5]) + rng.normal(size=(flights, 4)) * NOISE
    values += shift * ((previous == 7) * np.exp(-coast))[:, None] * SHIFT + slope * offset @ SLOPE.T
    return Entries(np.arange(flights), values, previous, coast, offset)


def test_a_planted_dependence_is_chosen_and_found_again() -> None:
    known = [entries(seed) for seed in range(8)]
    terms = choose_terms(known)
    assert (terms.shifts, terms.velocity) == (True, True)
    # Many flights: shrinkage is then nothing.
    fit = fit_entries(entries(50, flights=20_000), replace(terms, fade_time=1.0))
    assert fit.previous == (7, 8)
    assert fit.shifts[0] - fit.shifts[1] == pytest.approx(SHIFT, abs=0.02)
    assert fit.velocity == pytest.approx(SLOPE, abs=0.06)
    errors = held_out_errors(known[0], terms)
    assert errors.std(axis=0) == pytest.approx(NOISE, rel=0.35)


@pytest.mark.parametrize(
    ("shift", "slope", "expected"),
    [(0.0, 0.0, (False, False)), (0.0, 1.0, (False, True)), (1.0, 0.0, (True, False))],
)
def test_terms_that_are_not_there_are_not_chosen(
    shift: float, slope: float, expected: tuple[bool, bool]
) -> None:
    terms = choose_terms([entries(seed, shift=shift, slope=slope) for seed in range(8)])
    assert (terms.shifts, terms.velocity) == expected


def test_few_flights_choose_no_terms() -> None:
    assert choose_terms([entries(seed, flights=8) for seed in range(8)]) == NO_TERMS


def test_a_rare_previous_maneuver_shifts_little() -> None:
    many = entries(1, flights=40)
    rare = replace(many, previous=np.where(np.arange(40) == 0, 9, 8), coast=np.zeros(40))
    values = rare.values.copy()
    values[0] += 1.0
    fit = fit_entries(replace(rare, values=values), EntryTerms(shifts=True, velocity=False, penalty=4.0))
    assert np.abs(fit.shifts[fit.previous.index(9)]).max() < 0.35


def test_a_constant_model_is_the_mean() -> None:
    known = entries(2)
    fit = fit_entries(known, NO_TERMS)
    assert fit.means(known) == pytest.approx(np.tile(known.values.mean(axis=0), (60, 1)), abs=1e-12)
