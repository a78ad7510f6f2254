"""The automaton vehicle by joint laws: means, samples, entries, tube."""

from dataclasses import replace

import numpy as np
import pytest

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.se2 import SE2
from planner.closed_loop.joint_law_vehicle import JointLawVehicle, NoLawError
from planner.closed_loop.remaining_plan import PlanStep
from planner.closed_loop.tube import tube_exit_time
from tests.support.joint_laws import with_laws
from tests.support.synthetic_log import synthetic_library

LIBRARY = with_laws(synthetic_library())
START = SE2(3.0, -2.0, 0.7)


def vehicle(seed: int, *, library: Library = LIBRARY, trim: int = 1) -> JointLawVehicle:
    return JointLawVehicle(library, start=START, trim=trim, rng=np.random.default_rng(seed))


def test_a_library_without_laws_cannot_be_flown_by_them() -> None:
    with pytest.raises(NoLawError, match=r"expected a joint law for every primitive .*, trim 1 has none"):
        vehicle(1, library=synthetic_library())


def test_a_maneuver_from_another_trim_is_refused() -> None:
    with pytest.raises(FlightError, match="expected trim 2 at its start, got 1"):
        vehicle(1).perform(LIBRARY.maneuver(2, 1))


def test_a_maneuver_ends_at_the_law_s_mean_plus_a_deviation() -> None:
    row = LIBRARY.maneuver(1, 3)
    assert row.law is not None
    assert row.law.entry is not None
    for seed in range(20):
        flown = vehicle(seed)
        command, believed = LIBRARY.trim(1).velocity, flown.velocity
        offset = (
            believed.forward - command.forward,
            believed.side - command.side,
            believed.yaw_rate - command.yaw_rate,
        )
        leg = flown.perform(row)
        moved = START.inverse() @ SE2(*leg.track[-1, 1:].tolist())
        off = np.subtract(
            (leg.duration, moved.x, moved.y, moved.heading), row.law.mean_after(None, 0.0, offset)
        )
        assert min(np.abs(off - dev).max() for dev in np.array(row.law.entry.deviations)) < 1e-9
        assert leg.believed == believed
        assert flown.trim == 3


def test_a_coast_drifts_by_the_mean_velocity_not_by_the_command() -> None:
    drifts = []
    for seed in range(200):
        leg = vehicle(seed, trim=3).coast(4.0)
        moved = START.inverse() @ SE2(*leg.track[-1, 1:].tolist())
        drifts.append(moved.x)
    command, law = LIBRARY.trim(3).velocity.forward, LIBRARY.trim(3).law
    assert law is not None
    # Four standard errors of the mean.
    spread = law.standard_deviation_after(4.0)[0] / np.sqrt(200)
    assert np.mean(drifts) == pytest.approx(4.0 * (command + 0.1), abs=4 * spread)
    assert np.std(drifts) == pytest.approx(law.standard_deviation_after(4.0)[0], rel=0.25)


def claiming(library: Library, *, size: float) -> Library:
    """Returns the library with bounds by entry and growth, of some size."""
    rows = []
    for row in library.maneuvers:
        assert row.law is not None
        assert row.law.entry is not None
        entry = replace(row.law.entry, bounds=(size, 2 * size, 2 * size, 0.2 * size), coverage=0.9)
        rows.append(replace(row, law=replace(row.law, entry=entry)))
    trims = []
    for trim in library.trims:
        assert trim.law is not None
        trims.append(replace(trim, law=replace(trim.law, bounds=(40 * size,) * 3, coverage=0.9)))
    return replace(library, trims=tuple(trims), maneuvers=tuple(rows))


def exits(library: Library, *, share: float) -> int:
    """Returns the number of twenty flights that leave the tube."""
    gone = 0
    for seed in range(20):
        flown = vehicle(seed, library=library)
        steps = [
            PlanStep(1, 2.0),
            PlanStep(1, 0.0, 3),
            PlanStep(3, 1.5),
            PlanStep(3, 1.5),
            PlanStep(3, 0.0, 1),
        ]
        legs = [
            flown.coast(step.duration)
            if step.to_trim is None
            else flown.perform(library.maneuver(step.trim, step.to_trim))
            for step in steps
        ]
        gone += tube_exit_time(library, steps, legs, [0.0], share=share) is not None
    return gone


def test_the_tube_of_the_laws_holds_flights_by_them_and_a_small_one_does_not() -> None:
    assert exits(claiming(LIBRARY, size=0.11), share=1.0) == 0
    assert exits(claiming(LIBRARY, size=0.03), share=1.0) > 10
