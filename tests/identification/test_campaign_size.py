"""Tests of campaigns before flight: size, wind and forecast."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import pi
from time import perf_counter

import pytest
from scipy.stats import kstest, uniform

from experiments.campaign.campaign_size import campaign_size
from experiments.campaign.fly_campaign import (
    BOUNDING,
    CENTRING,
    MEASURING,
    TESTING,
    campaign_library,
    specify_campaign,
)
from experiments.campaign.forecast import forecast_with_executor
from flight.errors import FlightError
from identification.statistics.coverage import joint_coverage
from scenarios.find import find_campaign
from sim.campaign_flight import fly_specification
from sim.loop.streams import Stream, random_stream
from sim.wind.wind import DrydenWind
from sim.wind.wind_class import wind_class

CAMPAIGN = find_campaign("gtmax")
LIBRARY = campaign_library(CAMPAIGN, "gtmax")


@pytest.mark.parametrize(
    ("nominal", "coverage", "bounding"), [(30, 0.95, 153), (0, 0.95, 260), (1, 0.99, 773), (30, 0.5, 13)]
)
def test_a_coverage_takes_so_many_flights(nominal: int, coverage: float, bounding: int) -> None:
    size = campaign_size(CAMPAIGN, coverage=coverage, confidence=0.95, flights=None, nominal_flights=nominal)
    assert (size.bounding, size.nominal, size.flights) == (bounding, nominal, bounding + nominal)
    support = 4 if nominal else 8
    assert joint_coverage(bounding, support=support, confidence=0.95) >= coverage
    assert joint_coverage(bounding - 1, support=support, confidence=0.95) < coverage


def test_the_shipped_campaign_flies_what_95_95_takes() -> None:
    own = campaign_size(CAMPAIGN, coverage=None, confidence=0.95, flights=None, nominal_flights=None)
    asked = campaign_size(CAMPAIGN, coverage=0.95, confidence=0.95, flights=None, nominal_flights=None)
    assert own == asked
    assert "153 flights for the bounds, 30 others for the values" in own.describe()


def test_a_coverage_and_a_number_of_flights_are_not_both_taken() -> None:
    with pytest.raises(FlightError, match="expected one of them, got both"):
        campaign_size(CAMPAIGN, coverage=0.9, confidence=0.95, flights=9, nominal_flights=None)
    with pytest.raises(FlightError, match=r"--coverage must be between 0 and 1, got 95\.0"):
        campaign_size(CAMPAIGN, coverage=95.0, confidence=0.95, flights=None, nominal_flights=None)


def test_the_mean_wind_comes_from_everywhere() -> None:
    flights = specify_campaign(CAMPAIGN, LIBRARY, seed=1, flights=300, wind="gtmax")
    blowing = [
        DrydenWind(
            wind_class("gtmax"),
            height=30.0,
            span=3.0,
            direction=flight.wind_from,
            step=0.01,
            rng=random_stream(flight.seed, Stream.WIND),
        ).direction
        for flight in flights
    ]
    assert kstest(blowing, uniform(-pi, 2 * pi).cdf).pvalue > 0.01
    assert kstest([flight.start.heading for flight in flights], uniform(-pi, 2 * pi).cdf).pvalue > 0.01


def test_all_roles_of_a_seed_fly_in_air_of_their_own() -> None:
    seeds = [
        flight.seed
        for role in (BOUNDING, CENTRING, TESTING, MEASURING)
        for flight in specify_campaign(CAMPAIGN, LIBRARY, seed=1, flights=200, wind="gtmax", role=role)
    ]
    assert len(set(seeds)) == 800


def test_a_forecast_counts_the_flights_that_it_measured_and_every_worker() -> None:
    """Uses this thread as the worker and flights of equal length."""
    few = replace(CAMPAIGN, coasting_range=(2.0, 2.1))
    with ThreadPoolExecutor(1) as executor:
        ahead = forecast_with_executor(
            executor, few, wind="gtmax", seed=1, flights=20, workers=1, began=perf_counter()
        )
        (flight,) = specify_campaign(few, LIBRARY, seed=2, flights=1, wind="gtmax")
        lasts = fly_specification(flight, LIBRARY).duration
    assert ahead.measured == 1
    assert ahead.flight_hours == pytest.approx(20 * lasts / 3600, rel=0.1)
    assert ahead.minutes > 60 * ahead.flight_hours / ahead.speed
    assert f"{ahead.minutes:.1f} minutes on this machine (1 test flights" in ahead.describe()


def test_a_long_campaign_is_forecast_from_more_flights() -> None:
    with ThreadPoolExecutor(1) as executor:
        ahead = forecast_with_executor(
            executor, CAMPAIGN, wind="gtmax", seed=1, flights=60, workers=1, began=perf_counter() - 6.0
        )
    assert ahead.measured == 3
    # The time to start workers is part of the forecast.
    assert ahead.minutes > 60 * ahead.flight_hours / ahead.speed + 0.1
