"""Tests of a flight's page against its log."""

import base64
import json
from dataclasses import replace
from html import unescape
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from flight.errors import FlightError
from flightlog.topics import ESTIMATE, TRUTH
from review.page.columns import MOST_POINTS
from review.page.decimation import decimate
from review.summary.summary import summarise
from tests.support.reviewed_flights import COASTS, LIBRARY, WALK, page_of, whole_flight
from tests.support.synthetic_log import synthetic_log


def content_of(page: str) -> Any:
    return json.loads(page.split('id="data">')[1].split("</script>", maxsplit=1)[0])


def unpacked(text: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), "<f4")


@given(
    values=arrays(
        np.float64, st.tuples(st.integers(1, 300), st.just(2)), elements=st.floats(-9, 9, width=32)
    ),
    most=st.integers(2, 40),
)
def test_decimation_keeps_every_extreme_and_no_more_points_than_asked(values: np.ndarray, most: int) -> None:
    time = np.arange(len(values), dtype=np.float64)
    thin_time, thin = decimate(time, values, most=2 * most)
    assert len(thin_time) == len(thin) <= max(2 * most, 2)
    assert (np.diff(thin_time) >= 0).all()
    np.testing.assert_array_equal(thin.min(axis=0), values.min(axis=0))
    np.testing.assert_array_equal(thin.max(axis=0), values.max(axis=0))
    assert (thin_time[0], thin_time[-1]) == (time[0], time[-1])


def test_a_single_spike_in_a_long_flight_is_still_on_the_page() -> None:
    values = np.zeros((500_000, 1))
    values[123_457] = 7.0
    time, thin = decimate(0.01 * np.arange(500_000), values, most=MOST_POINTS)
    assert thin.max() == 7.0
    assert abs(time[int(thin.argmax())] - 1234.57) < 5000.0 / MOST_POINTS


def test_the_curves_are_the_numbers_of_the_log() -> None:
    log = whole_flight()
    content = content_of(page_of(log))
    forward = next(panel for panel in content["panels"] if panel["title"] == "Forward speed")
    assert [curve["role"] for curve in forward["curves"]] == ["commanded", "estimated", "actual"]
    for curve, topic in zip(forward["curves"][1:], (ESTIMATE, TRUTH), strict=True):
        base = content["bases"][curve["base"]]
        np.testing.assert_allclose(unpacked(base["time"]), log[topic].time, rtol=1e-6)
        np.testing.assert_allclose(
            unpacked(base["columns"][curve["column"]]), log[topic]["forward"], rtol=1e-6, atol=1e-7
        )
    pedal = next(panel for panel in content["panels"] if panel["title"].startswith("Tail rotor"))
    assert pedal["limits"] == pytest.approx(np.degrees([-0.3, 0.4]))
    north = next(panel for panel in content["panels"] if panel["title"].endswith("north"))
    assert {curve["role"] for curve in north["curves"]} == {"error", "sigma_high", "sigma_low"}
    assert len(content["flights"][0]["plans"]) == 3
    assert content["flights"][0]["goal"] == {"north": 20.0, "east": 10.0, "tolerance": 2.0}


def test_every_primitive_stands_in_the_table_with_its_deviation_against_its_bound() -> None:
    content = content_of(page_of(whole_flight()))
    primitives = content["flights"][0]["primitives"]
    assert [part["kind"] for part in primitives] == ["coast", "maneuver"] * 3 + ["coast"]
    for part in primitives:
        judged = part["judged"]
        assert judged["share"] == pytest.approx(abs(judged["deviation"]) / judged["bound"])
        assert judged["left"] == (judged["share"] > 1.0)


def test_a_meagre_log_has_a_page_and_what_is_missing_is_not_on_it() -> None:
    log = synthetic_log(LIBRARY, WALK, COASTS, seed=1)
    bare = replace(
        log, series={name: log.series[name] for name in (TRUTH.name, "/primitive")}, attachments={}
    )
    content = content_of(page_of(bare))
    assert {panel["section"] for panel in content["panels"]} == {"Motion", "Attitude"}
    assert {curve["role"] for panel in content["panels"] for curve in panel["curves"]} <= {
        *("actual", "component0", "component1", "component2")
    }
    (flight,) = content["flights"]
    assert (flight["goal"], flight["wind"], flight["estimated"], flight["plans"]) == (None, None, None, [])
    assert all(part["judged"] is None for part in flight["primitives"])


def test_a_log_of_an_estimate_alone_is_reviewed_as_the_estimate() -> None:
    log = whole_flight()
    estimated = replace(log, series={ESTIMATE.name: log[ESTIMATE]})
    summary = summarise(estimated)
    assert (summary.tracking, summary.navigation, summary.bounds, summary.arrival) == (None,) * 4
    assert summary.distance is not None
    assert summary.distance > 1.0
    content = content_of(page_of(estimated))
    assert content["flights"][0]["primitives"] == []
    assert {curve["role"] for panel in content["panels"][:4] for curve in panel["curves"]} == {"estimated"}


def test_equal_logs_give_equal_pages() -> None:
    assert page_of(whole_flight()) == page_of(whole_flight())


def test_a_name_that_is_html_stays_a_name() -> None:
    name = "</script><img src=x onerror=alert(1)>{{data}}"
    page = page_of(whole_flight(name=name))
    assert content_of(page)["flights"][0]["name"] == name
    assert unescape(page.split("<title>")[1].split("</title>")[0]) == f"Mission {name}"
    assert page.count("</script") == page_of(whole_flight()).count("</script")


def test_a_log_with_numbers_that_are_not_finite_is_refused_in_one_line() -> None:
    log = whole_flight()
    values = log[TRUTH].values.copy()
    values[7, 3] = np.nan
    broken = replace(log, series={**log.series, TRUTH.name: replace(log[TRUTH], values=values)})
    with pytest.raises(FlightError, match="expected finite numbers in the log, got NaN"):
        page_of(broken)


def test_half_an_hour_fits_in_a_page_that_can_be_sent() -> None:
    assert len(page_of(whole_flight(coasts=(450.0,) * 4))) < 15e6
