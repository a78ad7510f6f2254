"""Laws of trims: planted fluctuations are found again, bounds hold at all durations."""

from dataclasses import replace
from math import exp

import numpy as np
import pytest

from flight.automaton.joint_law import TrimLaw
from identification.segmentation.flight_evidence import FlightEvidence, extract_evidence
from identification.segmentation.segmentation import CoastSegment, Segments
from identification.statistics.trim_law import growth_ratios, identify_trim_law
from tests.support.synthetic_log import synthetic_library, synthetic_log

LIBRARY = synthetic_library()
TRIM = LIBRARY.trim(3)
BETWEEN, WITHIN, TIME = np.array([0.05, 0.04, 0.005]), np.array([0.10, 0.08, 0.02]), 0.6
OFF = np.array([0.1, 0.0, 0.01])
STEP = 0.02


def flights(seed: int, count: int) -> list[FlightEvidence]:
    """Returns flights with three coasts of planted fluctuations each."""
    rng = np.random.default_rng(seed)
    log = synthetic_log(LIBRARY, (3, 2), (1.0, 1.0), seed=1)
    first = extract_evidence(log, name="first", sha256="0")
    found = []
    for number in range(count):
        shared = rng.normal(size=3) * BETWEEN
        coasts = tuple(coast(rng, shared) for _ in range(3))
        found.append(replace(first, sha256=f"{seed}-{number}", segments=Segments((), coasts)))
    return found


def coast(rng: np.random.Generator, shared: np.ndarray) -> CoastSegment:
    duration = round(float(rng.uniform(1.0, 8.0)) / STEP) * STEP
    keep, samples = exp(-STEP / TIME), [rng.normal(size=3) * WITHIN]
    for _ in range(round(duration / STEP)):
        samples.append(keep * samples[-1] + np.sqrt(1 - keep**2) * rng.normal(size=3) * WITHIN)
    velocity = TRIM.velocity
    mean = np.array([velocity.forward, velocity.side, velocity.yaw_rate]) + OFF + shared
    return CoastSegment(TRIM.id, 0.0, duration, mean + np.array(samples))


def identified(bounding: list[FlightEvidence], nominal: list[FlightEvidence]) -> TrimLaw:
    law = identify_trim_law(
        TRIM, bounding=bounding, nominal=nominal, chosen=[0, 1, 2], discarded=0, confidence=0.95
    )
    assert law is not None
    return law


def test_planted_fluctuations_are_found_again() -> None:
    law = identified(flights(1, 30), flights(2, 120))
    velocity = TRIM.velocity
    off = np.array([law.mean.forward - velocity.forward, law.mean.side, law.mean.yaw_rate])
    # Three standard errors of a mean over 120 flights.
    assert (np.abs(off - OFF) <= 3 * (BETWEEN + WITHIN) / np.sqrt(120)).all()
    for after in (0.5, 2.0, 6.0):
        grown = 2 * WITHIN**2 * TIME * (after - TIME * (1 - exp(-after / TIME)))
        expected = np.sqrt(BETWEEN**2 * after**2 + grown)
        assert law.standard_deviation_after(after) == pytest.approx(expected, rel=0.2)
    assert np.shape(law.deviations) == (3, 3)


def test_bounds_hold_in_new_flights_at_all_times_as_claimed() -> None:
    law = identified(flights(1, 60), flights(2, 60))
    assert law.bounds is not None
    assert 0.8 < law.coverage < 0.95
    ratios = [growth_ratios(flight.segments.coasts, law) for flight in flights(3, 200)]
    inside = np.mean([bool((one <= law.bounds).all()) for one in ratios if one is not None])
    assert inside >= law.coverage - 3 * np.sqrt(law.coverage * (1 - law.coverage) / 200)
    # Negative control: bounds of half the size do not hold.
    half = 0.5 * np.array(law.bounds)
    assert np.mean([bool((one <= half).all()) for one in ratios if one is not None]) < law.coverage


def test_bounds_grow_more_slowly_than_time_times_the_largest_instant() -> None:
    known = flights(1, 60)
    law = identified(known, flights(2, 60))
    found = law.bounds_after(6.0)
    assert found is not None
    velocity = TRIM.velocity
    command = np.array([velocity.forward, velocity.side, velocity.yaw_rate])
    largest = np.max(
        [np.abs(one.velocity - command).max(axis=0) for part in known for one in part.segments.coasts], axis=0
    )
    assert (np.array(found) < 0.75 * 6.0 * largest).all()


def test_without_nominal_flights_nothing_is_claimed() -> None:
    law = identified(flights(1, 20), [])
    assert (law.bounds, law.coverage, law.bounds_after(2.0)) == (None, 0.0, None)


def test_one_flight_has_no_law() -> None:
    (flight,) = flights(1, 1)
    law = identify_trim_law(TRIM, bounding=[flight], nominal=[], chosen=[0], discarded=0, confidence=0.95)
    assert law is None
