"""Tests of a flight's page in a real browser."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ACTUATORS, ESTIMATE, TRUTH
from tests.support.browser import Tab, browser
from tests.support.reviewed_flights import page_of, whole_flight

pytestmark = pytest.mark.browser


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


def test_a_heading_sorts_the_table(tab: Tab, tmp_path: Path) -> None:
    opened(tab, page_of(whole_flight()), tmp_path)
    tab.click("#primitives th:last-child button")
    shares = tab.run(
        "[...document.querySelectorAll('#primitives tbody tr')]"
        ".map(row => flights[0].primitives[row.dataset.place].judged.share)"
    )
    assert shares == sorted(shares, reverse=True)
    assert tab.complaints == []


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


@pytest.mark.parametrize("name", ["plain", "</script><img src=x onerror=alert(1)>"])
def test_a_page_asks_the_network_for_nothing(tab: Tab, tmp_path: Path, name: str) -> None:
    opened(tab, page_of(whole_flight(name=name)), tmp_path)
    assert tab.run("performance.getEntriesByType('resource').map(one => one.name)") == []
    assert tab.run("document.images.length") == 0
    assert tab.complaints == []


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


def imported(*fields: str) -> FlightLog:
    """Returns an imported log: an estimate of some fields, numbered controls."""
    log = whole_flight()
    truth = log[TRUTH]
    columns = np.column_stack([truth[field] for field in fields])
    controls = Series(ACTUATORS.only(["control_1", "control_2"]), truth.time, truth.values[:, 3:5])
    series = {
        ESTIMATE.name: Series(ESTIMATE.only(fields), truth.time, columns),
        ACTUATORS.name: controls,
    }
    return FlightLog(replace(log.header, kind="import"), series, {})


@pytest.mark.parametrize(
    ("fields", "panels"),
    [
        (("forward", "side", "descent", "roll", "pitch", "heading", "yaw_rate"), 8),
        (("north", "east"), 3),
        (("down", "roll"), 3),
        (("north", "east", "forward", "side", "heading", "yaw_rate"), 7),
    ],
)
def test_a_log_of_another_vehicle_shows_what_it_has_without_complaint(
    tab: Tab, tmp_path: Path, fields: tuple[str, ...], panels: int
) -> None:
    opened(tab, page_of(imported(*fields)), tmp_path)
    assert tab.run("page.panels.length") == panels
    assert tab.run("document.getElementById('view') !== null") == ("north" in fields)
    assert ("No map" in tab.run("document.querySelector('main').textContent")) == ("north" not in fields)
    tab.resize(390, 844, dark=True, phone=True)
    assert tab.run("document.scrollingElement.scrollWidth <= innerWidth")
    assert tab.complaints == []


def test_flights_with_and_without_positions_are_compared(tab: Tab, tmp_path: Path) -> None:
    blind = imported("down", "forward", "side", "roll", "pitch", "heading", "yaw_rate")
    opened(tab, page_of(whole_flight(), blind), tmp_path)
    assert tab.run("placed.length") == 1
    opened(tab, page_of(blind, whole_flight()), tmp_path)
    assert tab.run("placed.length") == 1
    assert tab.complaints == []


def test_spectra_are_drawn_where_they_come_into_view_and_follow_the_theme(tab: Tab, tmp_path: Path) -> None:
    opened(tab, page_of(whole_flight()), tmp_path)
    tab.run("document.getElementById('spectra').scrollIntoView({behavior: 'instant'})")
    for _ in range(3):
        tab.settle()
    assert tab.run("spectrumPlots.map(slot => slot.plot !== null)") == [True, True]
    assert tab.run("spectrumPlots[1].plot.scales.x.max") == pytest.approx(25.0, rel=0.02)
    before = tab.run("spectrumPlots[0].plot.series[1].stroke()")
    tab.click("#theme")
    assert tab.run("spectrumPlots[0].plot.series[1].stroke()") != before
    assert tab.complaints == []


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


def test_a_script_that_fails_is_noticed(tab: Tab, tmp_path: Path) -> None:
    """Tests a failing script as the negative control."""
    opened(tab, page_of(whole_flight()).replace("writeTiles();\n", "noSuchThing();\n"), tmp_path)
    assert any("noSuchThing is not defined" in one for one in tab.complaints)
