"""`maneuver verify`: physics, margins and formats against their limits."""

import json as json_module
import sys
from collections.abc import Callable, Iterable
from dataclasses import asdict
from math import hypot
from pathlib import Path
from statistics import median
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from experiments.campaign.fly_campaign import campaign_library, specify_campaign
from flight.automaton.library import Library
from flight.errors import FlightError
from flight.plural import plural
from runtime.executor import default_workers, worker_pool
from scenarios.find import find_campaign, find_library
from sim.checks.check_result import CheckResult
from sim.loop.specification import FlightSpecification

CHECK_FAILED = 1
TOPICS = (
    *("trim", "power", "ground", "modes", "shape", "response", "limits"),
    *("margins", "delay", "adaptation", "wind", "navigation", "alarms", "numerics"),
)
_CAMPAIGN = "gtmax"
# Flights in which no limit may be met; not those of the shipped library.
_LIMITS_SEED, _LIMITS_FLIGHTS = 2, 4
# Of the table where it goes to a file.
_WIDTH = 150


def verify(
    *,
    topics: Annotated[tuple[str, ...], Parameter(consume_multiple=True)] = (),
    spectrum: Path | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Checks physics and margins of the simulator against their limits.

    The exit code is 1 if a value violates its limit.

    For example:

        maneuver verify

        maneuver verify --topics trim modes

        maneuver verify --topics wind --spectrum spectrum.png

        maneuver verify --json

    Args:
        topics: topics to check; all by default: trim, power, ground, modes, shape, response, limits, margins,
            delay, adaptation, wind, navigation, alarms and numerics.
        spectrum: picture of the gusts' spectra beside the standard's.
        json: print one JSON document.
    """
    unknown = sorted(set(topics) - set(TOPICS))
    if unknown:
        raise FlightError(f"no topic {', '.join(unknown)}; the topics are {', '.join(TOPICS)}")
    if spectrum is not None:
        _draw(spectrum)
    figures = list(measure(topics))
    if json:
        rows = [asdict(figure) | {"holds": figure.passed} for figure in figures]
        sys.stdout.write(json_module.dumps({"figures": rows}, indent=2) + "\n")
    else:
        _print_checks(figures)
    return 0 if figures and all(figure.passed for figure in figures) else CHECK_FAILED


def _draw(path: Path) -> None:
    from review.pictures.spectrum_picture import draw_spectra
    from sim.checks.gust_spectra import fly_course, gust_spectra

    frequency, found = gust_spectra(fly_course("crosswind"))
    draw_spectra(frequency, found, path)


def measure(topics: tuple[str, ...]) -> Iterable[CheckResult]:
    """Yields the checks of the topics; of all topics by default."""
    from sim.checks.controller_check import check_adaptation, check_delay, check_margins
    from sim.checks.limits_check import check_limits
    from sim.checks.numerics_check import check_numerics
    from sim.checks.response_check import check_response, check_table_10
    from sim.checks.vehicle_check import check_vehicle
    from sim.checks.wind_check import check_wind
    from sim.vehicle.parameters import read_parameters

    vehicle = read_parameters()
    checks: tuple[tuple[set[str], Callable[[], Iterable[CheckResult]]], ...] = (
        ({"trim", "power", "ground", "modes", "shape"}, lambda: check_vehicle(vehicle)),
        ({"response"}, lambda: check_response(vehicle)),
        ({"response"}, lambda: check_table_10(_library("calm"))),
        ({"limits"}, lambda: check_limits(_campaign_flights(), _library("gtmax"), vehicle)),
        ({"margins"}, lambda: check_margins(vehicle)),
        ({"delay"}, lambda: check_delay(vehicle)),
        ({"adaptation"}, lambda: check_adaptation(vehicle)),
        ({"wind"}, check_wind),
        ({"navigation"}, _check_navigation),
        ({"alarms"}, _check_alarms),
        (
            {"numerics"},
            lambda: check_numerics(vehicle, displacement_error=_median_displacement_error()),
        ),
    )
    for covered, check in checks:
        if not topics or covered.intersection(topics):
            yield from (figure for figure in check() if not topics or figure.topic in topics)


def _library(wind: str) -> Library:
    """Returns the thesis's library (Tables 9, 10) with a maneuver-end rule."""
    return campaign_library(find_campaign(_CAMPAIGN), wind)


def _campaign_flights() -> tuple[FlightSpecification, ...]:
    """Returns flights of the identification's campaign, with every maneuver in each."""
    campaign = find_campaign(_CAMPAIGN)
    wind = campaign.wind
    return specify_campaign(campaign, _library(wind), seed=_LIMITS_SEED, flights=_LIMITS_FLIGHTS, wind=wind)


def _check_navigation() -> Iterable[CheckResult]:
    from sim.checks.navigation_check import check_navigation

    with worker_pool(default_workers()) as executor:
        yield from check_navigation(_library("gtmax"), executor=executor)


def _check_alarms() -> Iterable[CheckResult]:
    from sim.checks.alarm_check import check_alarms

    with worker_pool(default_workers()) as executor:
        yield from check_alarms(_library("gtmax"), executor=executor)


def _median_displacement_error() -> float:
    """Returns the median displacement error of the shipped library's maneuvers, in metres."""
    maneuvers = find_library("gtmax-sim").maneuvers
    return median(hypot(maneuver.error.forward, maneuver.error.side) for maneuver in maneuvers)


def _print_checks(figures: list[CheckResult]) -> None:
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=_WIDTH)
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("topic", "check", "value", "unit", "limit", "", "reference"):
        table.add_column(heading, justify="right" if heading == "value" else "left")
    for figure in figures:
        verdict = "" if not figure.limit_text else "holds" if figure.passed else "MISSED"
        table.add_row(
            *(figure.topic, figure.name, f"{figure.value:.4g}", figure.unit),
            *(figure.limit_text, verdict, figure.beside),
        )
    console.print(table)
    missed = sum(not figure.passed for figure in figures)
    console.print(f"{plural(len(figures), 'check')}, {missed} outside the limit")
