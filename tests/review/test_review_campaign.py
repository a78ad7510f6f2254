"""Tests of a campaign's index and of compared flights."""

import json
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest

from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from flightlog.topics import TRUTH
from maneuver.app import run
from review.page.campaign_page import campaign_page
from review.page.campaign_rows import FlightRow, flight_row, sort_outliers_first
from review.page.comparison import comparison_rows
from review.summary.bound_check import with_bounds_of
from review.summary.summary import summarise
from tests.support.altered_logs import bound_for
from tests.support.browser import browser
from tests.support.synthetic_log import synthetic_library, synthetic_log

LIBRARY = synthetic_library()


def flight(seed: int, *, name: str = "tour") -> FlightLog:
    return synthetic_log(LIBRARY, (1, 2, 3), (2.0, 2.0, 2.0), seed=seed, kind="campaign", name=name)


def disturbed(log: FlightLog, amount: float) -> FlightLog:
    values = log[TRUTH].values.copy()
    values[:, TRUTH.field_names.index("side")] += amount
    return replace(log, series={**log.series, TRUTH.name: replace(log[TRUTH], values=values)})


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Writes nine ordinary flights, an outlier, a lost and a truncated one."""
    folder = tmp_path_factory.mktemp("campaign")
    for seed in range(9):
        write_log(flight(seed), folder / f"ordinary-{seed}.mcap")
    write_log(disturbed(flight(20), 1.0), folder / "sideways.mcap")
    lost = flight(21)
    write_log(replace(lost, header=replace(lost.header, outcome="flight lost")), folder / "lost.mcap")
    write_log(flight(22), folder / "whole.mcap")
    (folder / "cut.mcap").write_bytes((folder / "whole.mcap").read_bytes()[:5000])
    (folder / "whole.mcap").unlink()
    return folder


def test_what_failed_comes_first_then_what_stands_out(campaign: Path) -> None:
    rows = sort_outliers_first([flight_row(path) for path in sorted(campaign.iterdir())])
    assert [row.path.name for row in rows[:3]] == ["cut.mcap", "lost.mcap", "sideways.mcap"]
    assert [row.score for row in rows[:2]] == [inf, inf]
    assert "maneuver recover" in rows[0].problem
    assert rows[2].score > 5.0
    assert rows[2].reason in {"sideward speed error", "deviation over its bound"}
    assert all(2.0 * row.score < rows[2].score for row in rows[3:])
    assert len(rows) == 12


def test_a_single_flight_and_an_empty_campaign_have_no_outlier() -> None:
    assert sort_outliers_first([]) == ()
    (alone,) = sort_outliers_first([FlightRow(Path("a.mcap"), good=True, figures=(("side", 3.0),))])
    assert alone.score == 0.0


def test_a_spark_keeps_the_worst_moment(campaign: Path) -> None:
    row = flight_row(campaign / "sideways.mcap")
    off = np.hypot(
        *(
            disturbed(flight(20), 1.0)[TRUTH][name] - flight(20).series["/command"][name]
            for name in ("forward", "side")
        )
    )
    assert max(row.spark) == pytest.approx(off.max(), abs=1e-4)


def test_the_folder_is_reviewed_with_pages_for_the_first_and_exit_code_1(
    campaign: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    order = [
        *("review", str(campaign), "--html", "--pages", "2", "--out", str(tmp_path), "--workers", "1"),
        "--json",
    ]
    assert run(order) == 1
    content = json.loads(capsys.readouterr().out)
    assert [Path(path).name for path in content["files"]] == ["index.html", "lost.html", "sideways.html"]
    assert content["flights"][0]["path"].endswith("cut.mcap")
    assert content["flights"][0]["score"] is None
    assert run(order) == 2
    assert "give --force" in capsys.readouterr().err


@pytest.mark.browser
def test_the_index_sorts_and_links_in_a_browser(campaign: Path, tmp_path: Path) -> None:
    rows = sort_outliers_first([flight_row(path) for path in sorted(campaign.iterdir())])
    page = campaign_page(rows, title="<b>tour</b>", pages={rows[2].path: "sideways.html"})
    (tmp_path / "index.html").write_text(page, encoding="utf-8")
    with browser(tmp_path / "profile") as tab:
        tab.open(tmp_path / "index.html")
        names = (
            "[...document.querySelectorAll('#flights tbody tr td:nth-child(2)')].map(one => one.textContent)"
        )
        assert tab.run(names) == [row.path.name for row in rows]
        assert tab.run("document.querySelector('#flights a').getAttribute('href')") == "sideways.html"
        assert tab.run("document.querySelectorAll('#flights svg').length") == 11
        tab.click("#flights th:nth-child(2) button")
        assert tab.run(names) == sorted(row.path.name for row in rows)
        tab.resize(390, 844, phone=True)
        assert tab.run("document.scrollingElement.scrollWidth <= innerWidth")
        assert tab.complaints == []


def test_two_flights_of_one_mission_stand_side_by_side(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    paths = []
    for name, goal in (("nominal", (90.0, 0.0)), ("worst-case", (4.0, 0.0))):
        write_log(bound_for(flight(1, name="gtmax-1"), goal, 1.0), tmp_path / f"{name}.mcap")
        paths.append(str(tmp_path / f"{name}.mcap"))
    assert run(["review", *paths, "--html", "--out", str(tmp_path / "review")]) == 0
    said = capsys.readouterr().out
    assert "not reached: " in said
    assert "reached after" in said
    assert (tmp_path / "review" / "nominal-and-worst-case.html").is_file()


def test_a_comparison_leaves_out_values_that_no_flight_has() -> None:
    assert "left their bounds" not in {name for name, *_ in comparison_rows([summarise(flight(1))] * 2)}
    summary = summarise(with_bounds_of(flight(1), synthetic_library()))
    rows = {name for name, *_ in comparison_rows([summary, summary])}
    assert "goal" not in rows
    assert "left their bounds" in rows


@pytest.mark.parametrize(
    ("order", "words"),
    [
        (["--png"], "expected a single log, got several"),
        (["--out", "there"], "expected --html or --png, got neither"),
        (["x.mcap"], "expected logs or one folder"),
    ],
)
def test_invalid_options_are_refused_in_one_line(
    campaign: Path, order: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["review", str(campaign), *order]) == 2
    refusal = capsys.readouterr().err
    assert words in refusal
    assert refusal.count("\n") == 1


def test_a_folder_without_logs_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["review", str(tmp_path)]) == 2
    assert "expected flight logs (*.mcap), got none" in capsys.readouterr().err
