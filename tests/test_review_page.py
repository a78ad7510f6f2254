"""The page of a flight holds what its log holds, and works in a real browser."""

import base64
import json
from collections.abc import Iterator
from dataclasses import replace
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from flight.errors import FlightError
from flight.log import (
    CONTROLS,
    ESTIMATE,
    MISSION_ATTACHMENT,
    NAVIGATION,
    PLANS_ATTACHMENT,
    TRUTH,
    VEHICLE_ATTACHMENT,
    FlightLog,
    Series,
)
from flight.se2 import SE2
from review.control_limits import control_limits
from review.decimation import decimate
from review.page import Reviewed, review_page
from review.page_columns import MOST_POINTS
from review.summary import summarise
from tests.browser import CHROMIUM, Tab, browser
from tests.synthetic_log import synthetic_library, synthetic_log

LIBRARY = synthetic_library()
WALK, COASTS = (1, 2, 3, 7), (2.0,) * 4
needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")


def whole_flight(*, coasts: tuple[float, ...] = COASTS, seed: int = 1, name: str = "synthetic") -> FlightLog:
    """Returns a mission's log with every topic and attachment that a page shows."""
    log = synthetic_log(
        LIBRARY, WALK, coasts, seed=seed, start=SE2(5.0, -3.0, 0.7), kind="mission", name=name
    )
    truth = log[TRUTH]
    controls = Series(CONTROLS, truth.time, 0.1 * truth.values[:, :8])
    spread = Series(NAVIGATION, truth.time[::5], np.full((len(truth.time[::5]), 9), 0.2))
    scenarios = [{"gamma": gamma, "cost": 20.0 - gamma, "coasting_times": coasts} for gamma in (0.0, -1.0)]
    plans = [
        {"time": time, "sequence": WALK, "gamma": 1.0, "scenarios": scenarios} for time in (0.0, 3.0, 6.0)
    ]
    servos = {"cyclic_limit": 0.1, "collective_low": -0.1, "collective_high": 0.2}
    files = {
        MISSION_ATTACHMENT: {"goal": [20.0, 10.0], "tolerance": 2.0},
        PLANS_ATTACHMENT: [*plans, {"time": 9.0, "scenarios": [], "reason": "nothing </script> found"}],
        VEHICLE_ATTACHMENT: {"servos": {**servos, "pedal_low": -0.3, "pedal_high": 0.4}},
    }
    attached = {name: json.dumps(content).encode() for name, content in files.items()}
    series = {**log.series, CONTROLS.name: controls, NAVIGATION.name: spread}
    return replace(log, series=series, attachments={**log.attachments, **attached})


def page_of(*logs: FlightLog) -> str:
    flights = [Reviewed(log, summarise(log), f"flight {place}") for place, log in enumerate(logs)]
    return review_page(flights, limits=control_limits(logs[0]))


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
    assert (flight["goal"], flight["wind"], flight["believed"], flight["plans"]) == (None, None, None, [])
    assert all(part["judged"] is None for part in flight["primitives"])


def test_a_log_of_an_estimate_alone_is_reviewed_as_what_was_believed() -> None:
    log = whole_flight()
    believed = replace(log, series={ESTIMATE.name: log[ESTIMATE]})
    summary = summarise(believed)
    assert (summary.tracking, summary.navigation, summary.bounds, summary.arrival) == (None,) * 4
    assert summary.distance is not None
    assert summary.distance > 1.0
    content = content_of(page_of(believed))
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
    with pytest.raises(FlightError, match="not finite"):
        page_of(broken)


def test_half_an_hour_fits_in_a_page_that_can_be_sent() -> None:
    assert len(page_of(whole_flight(coasts=(450.0,) * 4))) < 15e6


@pytest.fixture(scope="module")
def tab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    with browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


def opened(tab: Tab, page: str, folder: Path) -> None:
    path = folder / "page.html"
    path.write_text(page, encoding="utf-8")
    tab.complaints.clear()
    tab.resize(1440, 1000)
    tab.open(path)
    tab.settle()


@needs_browser
def test_a_click_on_a_primitive_takes_plots_map_and_lane_there(tab: Tab, tmp_path: Path) -> None:
    opened(tab, page_of(whole_flight()), tmp_path)
    whole = tab.run("[state.from, state.to]")
    ranges = "plots.filter(slot => slot.plot).map(slot => [slot.plot.scales.x.min, slot.plot.scales.x.max])"
    assert tab.run(ranges) == [whole] * len(tab.run(ranges)) != []
    part = tab.run("flights[0].primitives[3]")
    tab.click("#primitives tbody tr:nth-child(4)")
    shown = tab.run("[state.from, state.to]")
    assert shown[0] < part["start"] < part["end"] < shown[1]
    assert shown[1] - shown[0] < 0.6 * (whole[1] - whole[0])
    # Panels that are scrolled to afterwards begin where the others are.
    tab.run("document.getElementById('navigation').scrollIntoView({behavior: 'instant'})")
    tab.settle()
    np.testing.assert_allclose(tab.run(ranges), [shown] * len(tab.run(ranges)))
    assert tab.run("document.querySelector('tr.chosen').dataset.place") == "3"
    tab.click("#whole")
    assert tab.run("[state.from, state.to]") == whole
    assert tab.complaints == []


@needs_browser
def test_dragging_across_one_plot_moves_all_and_the_cursor_is_shared(tab: Tab, tmp_path: Path) -> None:
    opened(tab, page_of(whole_flight()), tmp_path)
    x, y = tab.middle(".panel .u-over")
    for kind, place in (
        ("mouseMoved", x),
        ("mousePressed", x),
        ("mouseMoved", x + 200),
        ("mouseReleased", x + 200),
    ):
        tab.mouse(kind, place, y)
    tab.settle()
    low, high = tab.run("[state.from, state.to]")
    assert 0.0 < low < high < tab.run("duration")
    tab.mouse("mouseMoved", x, y, button="none")
    tab.settle()
    time = tab.run("state.cursor")
    assert low < time < high
    values = tab.run("plots.filter(slot => slot.plot).map(slot => slot.outputs[0].textContent)")
    assert all(values)
    assert tab.complaints == []


@needs_browser
def test_a_click_on_the_track_and_on_the_lane_chooses_a_primitive(tab: Tab, tmp_path: Path) -> None:
    opened(tab, page_of(whole_flight()), tmp_path)
    place = "onScreen(size, ...['north', 'east', 'height'].map(name => placeAt(tracks[0], 3.0)[name]))"
    tab.run("viewCanvas.scrollIntoView({block: 'center', behavior: 'instant'})")
    box = tab.run("(({x, y}) => [x, y])(viewCanvas.getBoundingClientRect())")
    x, y = tab.run(place)
    tab.mouse("mousePressed", box[0] + x, box[1] + y)
    tab.mouse("mouseReleased", box[0] + x, box[1] + y)
    tab.settle()
    chosen = tab.run("flights[0].primitives[state.chosen.place]")
    assert chosen["start"] <= 3.0 <= chosen["end"]
    tab.click("#whole")
    tab.click("#lane")
    assert tab.run("state.chosen") is not None
    assert tab.complaints == []


@needs_browser
def test_a_heading_sorts_the_table(tab: Tab, tmp_path: Path) -> None:
    opened(tab, page_of(whole_flight()), tmp_path)
    tab.click("#primitives th:last-child button")
    shares = tab.run(
        "[...document.querySelectorAll('#primitives tbody tr')]"
        ".map(row => flights[0].primitives[row.dataset.place].judged.share)"
    )
    assert shares == sorted(shares, reverse=True)
    assert tab.complaints == []


@needs_browser
def test_on_a_phone_and_in_the_dark_nothing_is_wider_than_the_screen(tab: Tab, tmp_path: Path) -> None:
    opened(tab, page_of(whole_flight()), tmp_path)
    light = tab.run("getComputedStyle(document.body).backgroundColor")
    tab.resize(390, 844, dark=True, phone=True)
    assert tab.run("document.scrollingElement.scrollWidth <= innerWidth")
    assert tab.run("getComputedStyle(document.body).backgroundColor") != light
    tab.click("#theme")
    assert tab.run("getComputedStyle(document.body).backgroundColor") == light
    tab.click("[data-view=space]")
    assert tab.complaints == []


@needs_browser
@pytest.mark.parametrize("name", ["plain", "</script><img src=x onerror=alert(1)>"])
def test_a_page_asks_the_network_for_nothing(tab: Tab, tmp_path: Path, name: str) -> None:
    opened(tab, page_of(whole_flight(name=name)), tmp_path)
    assert tab.run("performance.getEntriesByType('resource').map(one => one.name)") == []
    assert tab.run("document.images.length") == 0
    assert tab.complaints == []


@needs_browser
def test_a_meagre_log_and_two_flights_side_by_side_are_shown_without_complaint(
    tab: Tab, tmp_path: Path
) -> None:
    log = whole_flight()
    bare = replace(
        log, series={TRUTH.name: log[TRUTH], "/primitive": log.series["/primitive"]}, attachments={}
    )
    opened(tab, page_of(bare), tmp_path)
    assert tab.complaints == []
    # Different samples: the curves of both are on one axis, each over its own times.
    opened(tab, page_of(log, whole_flight(coasts=(2.0, 2.0, 5.0, 3.0), seed=2)), tmp_path)
    assert tab.run("document.querySelectorAll('#scorecard tbody tr').length") > 5
    drawn = tab.run("plots[0].plot.data.slice(1).map(column => column.filter(one => one != null).length)")
    assert len(drawn) == 4
    assert min(drawn) > 100
    tab.click("#primitives tbody tr:nth-child(2)")
    assert tab.complaints == []


@needs_browser
def test_a_flight_lost_at_once_has_a_page_too(tab: Tab, tmp_path: Path) -> None:
    log = whole_flight()
    first = {
        name: Series(part.topic, part.time[:1], part.values[:1])
        for name, part in log.series.items()
        if part.time[0] == 0.0
    }
    lost = replace(log.header, outcome="flight lost at 0.00 s: met the ground")
    opened(tab, page_of(replace(log, header=lost, series=first)), tmp_path)
    assert "lost" in tab.run("document.getElementById('tiles').textContent")
    tab.click("[data-view=space]")
    assert tab.complaints == []


@needs_browser
def test_a_script_that_fails_is_noticed(tab: Tab, tmp_path: Path) -> None:
    """The negative control of every test that sees no complaint."""
    opened(tab, page_of(whole_flight()).replace("writeTiles();\n", "noSuchThing();\n"), tmp_path)
    assert any("noSuchThing is not defined" in one for one in tab.complaints)
