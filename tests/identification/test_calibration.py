"""Coverage of bounds of known distributions: 95 % with 95 % confidence."""

from itertools import islice
from statistics import median

import pytest
from scipy.stats import binom

from tests.support.deviation_laws import LAWS, Law
from tests.support.studies.calibration import (
    CONFIDENCE,
    COVERAGE,
    Primitive,
    calibration,
    median_size,
    shrunken,
    shuffled,
)
from tests.support.studies.study import Study

CAMPAIGN = 29
"""Primitives that one campaign identifies."""


def expected_at_most(primitives: int) -> int:
    """Returns how many cover less than they claim with a probability of at least 0.001."""
    return int(binom.isf(0.001, primitives, 1 - CONFIDENCE))


def covering_less(law: Law, primitives: list[Primitive]) -> int:
    return sum(primitive.true_coverage(law) < COVERAGE for primitive in primitives)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_few_primitives_cover_less_than_they_claim_and_many_with_bounds_that_are_wrong(law: Law) -> None:
    found, most = list(islice(calibration(law), CAMPAIGN)), expected_at_most(CAMPAIGN)
    assert most == 6
    assert covering_less(law, found) <= most
    assert covering_less(law, shrunken(found)) > most
    assert covering_less(law, shuffled(found)) > most


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_study_of_coverage_by_law(law: Law, study: Study) -> None:
    wanted = study.size("primitives", 200)
    found, most = list(islice(calibration(law, seed=study.size("seed", 1)), wanted)), expected_at_most(wanted)
    study.show(f"{law.name}: of {wanted} primitives at most {most} may cover less than they claim")
    less = {}
    for name, primitives in (
        ("as identified", found),
        ("shrunken", shrunken(found)),
        ("shuffled", shuffled(found)),
    ):
        less[name] = covering_less(law, primitives)
        cover = median(primitive.true_coverage(law) for primitive in primitives)
        size = median_size(law, primitives)
        study.show(f"  {name:<14} {less[name]:>4} cover less, median {cover:.3f}, bound/quantile {size:.2f}")
    assert less["as identified"] <= most < min(less["shrunken"], less["shuffled"])


@pytest.mark.slow
def test_study_of_bounds_by_flights_for_the_values(study: Study) -> None:
    wanted, sizes = study.size("primitives", 200), []
    for nominal in (5, 10, 20, 30, 60):
        found = islice(calibration(LAWS[0], nominal_flights=nominal, seed=study.size("seed", 1)), wanted)
        sizes.append(median_size(LAWS[0], list(found)))
        study.show(f"{nominal:>4} flights for the values: median bound {sizes[-1]:.3f} of the true quantile")
    # Bounds are taken around values that scatter the less, the more flights give them.
    assert sizes[0] == max(sizes)
    assert min(sizes) > 1.0
