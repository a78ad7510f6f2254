"""Tests of the shares of variance between flights, and of the study of error sources."""

import json
from pathlib import Path

import numpy as np
import pytest

from identification.design.schedule import schedule
from identification.statistics.variance_shares import TooFewRepetitionsError, source_shares, variance_share
from maneuver.app import run
from scenarios.find import find_library

LIBRARY = find_library("thesis-gtmax")


def drawn(
    rng: np.random.Generator, *, flights: int, each: int, between: float, within: float
) -> list[list[float]]:
    means = rng.normal(0.0, between, flights)
    return [list(mean + rng.normal(0.0, within, each)) for mean in means]


def test_the_share_of_a_textbook_example_is_the_one_by_hand() -> None:
    """Two flights of two: mean squares 16 between and 0.5 within, effective size 2."""
    found = variance_share([[1.0, 2.0], [5.0, 6.0]])
    assert found.within == pytest.approx(0.5)
    assert found.between == pytest.approx((16.0 - 0.5) / 2.0)
    assert found.share == pytest.approx(7.75 / 8.25)
    assert (found.flights, found.performances) == (2, 4)


def test_the_share_is_that_of_the_law_and_its_interval_covers_it() -> None:
    rng, covered, shares = np.random.default_rng(5), 0, []
    for _ in range(400):
        found = variance_share(drawn(rng, flights=20, each=3, between=2.0, within=1.0))
        shares.append(found.share)
        covered += found.low <= 0.8 <= found.high
    # Within three standard errors of 95 % of 400; the estimator's bias is below that of 20 flights' variance.
    assert 0.917 <= covered / 400 <= 0.983
    assert np.median(shares) == pytest.approx(0.8, abs=0.03)


def test_flights_that_share_nothing_have_a_share_near_zero() -> None:
    """Negative control."""
    found = variance_share(drawn(np.random.default_rng(6), flights=200, each=3, between=0.0, within=1.0))
    assert found.share < 0.1
    assert found.low == 0.0


def test_flights_of_different_sizes_count_by_their_effective_size() -> None:
    rng = np.random.default_rng(7)
    groups = [
        list(rng.normal(mean, 1.0, size))
        for mean, size in zip(rng.normal(0, 1, 600), [1, 2, 6] * 200, strict=True)
    ]
    assert variance_share(groups).share == pytest.approx(0.5, abs=0.06)


@pytest.mark.parametrize("groups", [[], [[1.0, 2.0]], [[1.0], [2.0]], [[], [1.0, 2.0]]])
def test_too_few_performances_are_refused(groups: list[list[float]]) -> None:
    with pytest.raises(TooFewRepetitionsError, match="maneuver 3: expected two flights and one with two"):
        variance_share(groups, name="maneuver 3")


def test_equal_performances_are_all_shared() -> None:
    found = variance_share([[1.0, 1.0], [2.0, 2.0]])
    assert (found.share, found.low, found.high) == (1.0, 1.0, 1.0)


def test_a_repeated_tour_has_every_maneuver_as_often() -> None:
    (tour,) = schedule(
        LIBRARY,
        flights=1,
        rng=np.random.default_rng(1),
        coasting_range=(1.0, 3.0),
        wind="calm",
        repetitions=2,
    )
    flown = list(zip(tour.trims[:-1], tour.trims[1:], strict=True))
    assert sorted(flown) == sorted(2 * [(row.from_trim, row.to_trim) for row in LIBRARY.maneuvers])


def test_sources_of_error_are_studied_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "sources.json"
    assert run(["library", "sources", "gtmax", "--flights", "2", "--workers", "1", "--out", str(out)]) == 0
    table = capsys.readouterr().out
    assert "| scalar | wind, % | noise, % | vehicle, % | sensor, % | shared by a flight, % |" in table
    document = json.loads(out.read_text())
    assert list(document["variances"]) == ["wind", "noise", "vehicle", "sensor", "all"]
    assert document["vehicles"] == "fleet"
    rows = document["variances"]["all"]
    assert len(rows) == 3 * len(LIBRARY.trims) + 4 * len(LIBRARY.maneuvers)
    assert all(0 <= row["low"] <= row["share"] <= row["high"] <= 1 for row in rows)
    assert source_shares({}) == {}
