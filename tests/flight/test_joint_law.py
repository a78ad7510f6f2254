"""Joint laws in libraries: round trips, versions, dependence on the entry, growth of errors."""

import json
from dataclasses import replace
from math import exp
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flight.automaton.joint_law import MOST_DEVIATIONS, VelocityFluctuation
from flight.automaton.library import SCHEMA, SCHEMA_WITHOUT_LAWS
from flight.automaton.library_file import library_hash, library_text, parse_library, read_library
from flight.errors import BadFileError
from tests.support.joint_laws import maneuver_law, with_laws
from tests.support.synthetic_log import synthetic_library

numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(numbers, numbers, numbers, numbers)
def test_laws_round_trip_to_the_last_bit(duration: float, forward: float, side: float, turn: float) -> None:
    library = synthetic_library()
    law = replace(maneuver_law(library.maneuvers[0], previous=3), mean=(duration, forward, side, turn))
    row = replace(library.maneuvers[0], law=law)
    changed = replace(library, maneuvers=(row, *library.maneuvers[1:]))
    again = parse_library(library_text(changed), "text")
    assert again == changed
    assert library_hash(again) == library_hash(changed)


def test_a_library_with_a_law_on_every_primitive_round_trips() -> None:
    library = with_laws(synthetic_library())
    assert parse_library(library_text(library), "text") == library


def test_a_library_with_laws_is_of_version_2_and_one_without_of_version_1() -> None:
    plain = synthetic_library()
    assert json.loads(library_text(plain))["schema"] == SCHEMA_WITHOUT_LAWS == "maneuver-library/1"
    assert json.loads(library_text(with_laws(plain)))["schema"] == SCHEMA == "maneuver-library/2"
    assert "law" not in library_text(plain)


def test_more_deviations_than_a_law_keeps_are_refused(tmp_path: Path) -> None:
    content = json.loads(library_text(with_laws(synthetic_library())))
    content["maneuvers"][0]["law"]["deviations"] *= MOST_DEVIATIONS
    path = tmp_path / "library.json"
    path.write_text(json.dumps(content))
    with pytest.raises(BadFileError, match=r"maneuvers\[0\].law.deviations: .*at most 64"):
        read_library(path)


def test_a_shift_by_the_previous_maneuver_fades_with_the_coast() -> None:
    maneuver = synthetic_library().maneuvers[0]
    law = maneuver_law(maneuver, previous=3)
    still = (0.0, 0.0, 0.0)
    assert law.mean_after(3, 0.0, still)[0] == pytest.approx(maneuver.duration + 0.3, abs=1e-12)
    assert law.mean_after(3, 1.0, still)[0] == pytest.approx(maneuver.duration + 0.3 * exp(-1.0), abs=1e-12)
    assert law.mean_after(4, 0.0, still) == law.mean_after(None, 0.0, still) == law.mean
    assert replace(law, entry=None).mean_after(3, 0.0, (1.0, 1.0, 1.0)) == law.mean


def test_a_faster_entry_carries_further() -> None:
    maneuver = synthetic_library().maneuvers[0]
    law = maneuver_law(maneuver, previous=3)
    found = law.mean_after(None, 0.0, (0.5, 0.0, 0.2))
    assert np.subtract(found, law.mean) == pytest.approx([0.05, 0.5, 0.0, 0.3], abs=1e-12)


def test_integrated_fluctuations_agree_with_a_simulated_process() -> None:
    rng = np.random.default_rng(3)
    spread, time, step, coast, count = 0.2, 0.7, 0.01, 4.0, 4000
    keep = exp(-step / time)
    velocity = rng.normal(0.0, spread, count)
    place = np.zeros(count)
    for _ in range(round(coast / step)):
        following = keep * velocity + rng.normal(0.0, spread * np.sqrt(1 - keep**2), count)
        place += step * (velocity + following) / 2
        velocity = following
    expected = VelocityFluctuation((spread,) * 3, (time,) * 3).integrated_variance(coast)[0]
    # Four standard errors of a variance from 4000 normal samples.
    assert place.var() == pytest.approx(expected, rel=4 * np.sqrt(2 / count))
