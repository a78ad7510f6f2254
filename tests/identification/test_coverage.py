"""Tests of box coverage against the binomial law and drawn samples."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import beta, binom

from identification.statistics.box import box_around, smallest_box
from identification.statistics.coverage import joint_coverage, samples_needed


@given(st.integers(1, 3000), st.integers(1, 12), st.floats(0.5, 0.999))
@settings(max_examples=300, deadline=None)
def test_the_coverage_inverts_the_binomial_tail(samples: int, support: int, confidence: float) -> None:
    coverage = joint_coverage(samples, support=support, confidence=confidence)
    if samples < support:
        assert coverage == 0.0
    else:
        tail = binom.cdf(support - 1, samples, 1 - coverage)
        assert tail == pytest.approx(1 - confidence, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(("support", "samples"), [(1, 59), (3, 124), (4, 153), (6, 208), (8, 260), (12, 361)])
def test_the_sample_sizes_of_the_scenario_bound(support: int, samples: int) -> None:
    """Tests the samples for 95 % coverage, and one fewer."""
    assert samples_needed(0.95, support=support, confidence=0.95) == samples
    assert joint_coverage(samples, support=support, confidence=0.95) >= 0.95
    assert joint_coverage(samples - 1, support=support, confidence=0.95) < 0.95


def test_99_percent_of_one_scalar_take_299_samples_and_of_six_1049() -> None:
    assert samples_needed(0.99, support=1, confidence=0.95) == 299
    assert samples_needed(0.99, support=6, confidence=0.95) == 1049


@given(st.integers(1, 12), st.integers(0, 10), st.floats(0.5, 0.99), st.floats(0.5, 0.99))
@settings(max_examples=100, deadline=None)
def test_the_samples_needed_are_enough_and_no_more(
    support: int, discarded: int, coverage: float, confidence: float
) -> None:
    count = samples_needed(coverage, support=support, confidence=confidence, discarded=discarded)
    claims = [
        joint_coverage(n, support=support, confidence=confidence, discarded=discarded)
        for n in (count - 1, count)
    ]
    assert claims[0] < coverage <= claims[1]


@given(st.integers(20, 500), st.integers(1, 8), st.integers(0, 8))
@settings(deadline=None)
def test_every_discarded_sample_weakens_the_claim(samples: int, support: int, discarded: int) -> None:
    claims = [
        joint_coverage(samples, support=support, confidence=0.95, discarded=count)
        for count in (discarded, discarded + 1)
    ]
    assert claims[1] < claims[0]


def failure_probability(samples: int, support: int, unsettled: float, *, claim: str) -> float:
    """Returns the exact probability that a claim of 95 % confidence fails.

    A sample is discarded with the probability `unsettled`; of the others the share outside the box follows a
    Beta(support, kept - support + 1) distribution, as for independent scalars.
    """
    failed = 0.0
    for count in range(samples - support + 1):
        if claim == "exact":
            claimed = joint_coverage(samples, support=support, confidence=0.95, discarded=count)
        else:
            claimed = 1 - beta.ppf(0.95, support + count, samples - support - count + 1)
        outside = max(0.0, (1 - claimed - unsettled) / (1 - unsettled))
        failed += binom.pmf(count, samples, unsettled) * beta.sf(
            outside, support, samples - count - support + 1
        )
    return failed


@pytest.mark.parametrize(("support", "samples"), [(3, 124), (4, 153), (8, 260)])
def test_the_claim_holds_however_often_maneuvers_do_not_settle(support: int, samples: int) -> None:
    chances = [0.0, *np.geomspace(1e-4, 0.5, 25)]
    assert (
        max(failure_probability(samples, support, chance, claim="exact") for chance in chances) <= 0.05 + 1e-9
    )
    # Without the combinatorial factor it does not hold.
    assert max(failure_probability(samples, support, chance, claim="naive") for chance in chances) > 0.055


@given(st.integers(0, 2**32 - 1), st.integers(2, 40), st.integers(1, 5))
@settings(deadline=None)
def test_both_boxes_hold_all_samples_and_touch_them(seed: int, count: int, scalars: int) -> None:
    rng = np.random.default_rng(seed)
    low = rng.standard_normal((count, scalars)) * 10.0 ** rng.integers(-6, 6, scalars)
    high = low + rng.exponential(size=low.shape)
    for box in (box_around(low.mean(axis=0), low, high), smallest_box(low, high)):
        assert box.contains(low, high).all()
        shrunken = type(box)(box.centre, box.size * (1 - 1e-9), box.support)
        assert not shrunken.contains(low, high).all()
    assert smallest_box(low, high).support == 2 * scalars
