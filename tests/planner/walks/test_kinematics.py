"""Tests of walk kinematics: numbers, symbols and arrays agree."""

from math import pi

import casadi
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.errors import NoManeuverError
from flight.se2 import SE2, Twist
from planner.walks.flow import WalkFlow, fly_walks, fold_turns
from planner.walks.kinematics import NegativeDurationError, WalkMotion, walk_motion
from tests.oracles.symbolic_motion import symbolic_motion

TWIN_AGREEMENT = 1e-10
"""Metres and radians, for ends within a kilometre."""

lengths = st.floats(-20, 20)
angles = st.floats(-pi, pi)
rates = st.one_of(st.sampled_from([0.0, 1e-300, -1e-300, 1e-12, -1e-12, 0.6]), st.floats(-1, 1))
poses = st.builds(SE2, lengths, lengths, angles)
twists = st.builds(Twist, lengths, lengths, rates)


@st.composite
def motions(draw: st.DrawFn) -> WalkMotion:
    trims = draw(st.integers(1, 4))
    return WalkMotion(
        velocities=tuple(draw(twists) for _ in range(trims)),
        displacements=tuple(draw(poses) for _ in range(trims - 1)),
        fixed_time=draw(st.floats(0, 10)),
    )


def times_for(numbers: WalkMotion, seed: int) -> tuple[float, ...]:
    return tuple(np.random.default_rng(seed).uniform(0, 8, len(numbers.velocities)).tolist())


@settings(max_examples=60, deadline=None)
@given(motions(), poses, st.integers(0, 1000))
def test_the_symbolic_end_of_a_walk_is_the_numeric_one(numbers: WalkMotion, start: SE2, seed: int) -> None:
    times = times_for(numbers, seed)
    twin = symbolic_motion(len(times))
    end = casadi.Function(
        "end", [twin.velocities, twin.displacements, twin.start, twin.coasting_times], [twin.end]
    )
    velocities = np.array([[v.forward, v.side, v.yaw_rate] for v in numbers.velocities]).T
    moved = np.array([[d.x, d.y, d.heading] for d in numbers.displacements]).reshape(-1, 3).T
    symbolic = np.array(end(velocities, moved, [start.x, start.y, start.heading], list(times))).ravel()
    numeric = numbers.end(start, times)
    assert symbolic == pytest.approx([numeric.x, numeric.y, numeric.heading], abs=TWIN_AGREEMENT)


def flow_of(numbers: WalkMotion, times: np.ndarray) -> tuple[WalkFlow, float]:
    """Returns the flow along one walk, and the heading change of its maneuvers."""
    turn = np.array([0.0, *(d.heading for d in numbers.displacements)])
    velocity, displacement, turned = fold_turns(
        np.array([complex(v.forward, v.side) for v in numbers.velocities]),
        np.array([0j, *(complex(d.x, d.y) for d in numbers.displacements)]),
        turn,
    )
    rate = np.array([v.yaw_rate for v in numbers.velocities])
    return fly_walks(velocity, rate, displacement, times), float(turned[-1])


@given(motions(), st.integers(0, 1000))
def test_the_end_of_a_walk_in_arrays_is_the_numeric_one(numbers: WalkMotion, seed: int) -> None:
    times = times_for(numbers, seed)
    flow, turned = flow_of(numbers, np.array(times))
    numeric = numbers.end(SE2.identity(), times)
    assert flow.end == pytest.approx(complex(numeric.x, numeric.y), abs=TWIN_AGREEMENT)
    assert flow.heading[-1] + turned == pytest.approx(numeric.heading, abs=TWIN_AGREEMENT)


@given(motions(), st.integers(0, 1000))
def test_the_end_moves_with_each_time_as_its_velocities_say(numbers: WalkMotion, seed: int) -> None:
    times = np.array(times_for(numbers, seed)) + 0.1
    velocity, step = flow_of(numbers, times)[0].velocity, 1e-5
    for place, held in enumerate(np.eye(len(times))):
        later, earlier = (flow_of(numbers, times + sign * step * held)[0].end for sign in (1, -1))
        # Second differences of positions up to some hundred metres.
        assert velocity[place] == pytest.approx((later - earlier) / (2 * step), abs=1e-5)


@given(motions(), st.integers(0, 1000))
def test_many_walks_at_once_are_flown_like_one(numbers: WalkMotion, seed: int) -> None:
    times = np.random.default_rng(seed).uniform(0, 8, (2, 3, len(numbers.velocities)))
    rate = np.array([v.yaw_rate for v in numbers.velocities])
    velocity = np.array([complex(v.forward, v.side) for v in numbers.velocities])
    nothing = np.zeros(len(rate), dtype=complex)
    many = fly_walks(velocity, rate, nothing, times)
    one = fly_walks(velocity, rate, nothing, times[1, 2])
    assert many.end[1, 2] == pytest.approx(one.end, abs=TWIN_AGREEMENT)
    assert many.velocity[1, 2] == pytest.approx(one.velocity, abs=TWIN_AGREEMENT)


def test_gamma_moves_a_walk_by_its_signed_errors() -> None:
    library = thesis_kinematic()
    nominal, wide = walk_motion(library, (1, 2, 5, 2), 0.0), walk_motion(library, (1, 2, 5, 2), 1.0)
    assert nominal.fixed_time == 2 + 4 + 4
    assert wide.fixed_time == 1.5 + 3.5 + 3.5
    assert wide.velocities[2].forward == pytest.approx(4.6)
    assert wide.velocities[2].yaw_rate == pytest.approx(-0.48)
    assert wide.displacements[1].x == 14 - 7


def test_a_walk_that_the_library_does_not_join_is_refused() -> None:
    with pytest.raises(NoManeuverError, match="no maneuver from trim 1 to trim 6; from trim 1 the library"):
        walk_motion(thesis_gtmax(), (2, 1, 6), 0.0)


def test_a_gamma_that_turns_a_duration_negative_is_refused() -> None:
    trims = (Trim(1, "slow", Twist(1, 0, 0), Twist(0, 0, 0)), Trim(2, "fast", Twist(2, 0, 0), Twist(0, 0, 0)))
    hasty = Maneuver(7, 1, 2, 1.0, SE2(1, 0, 0), ManeuverError(-1.5, 0, 0, 0))
    library = Library("hasty", "", "", trims, (hasty,))
    with pytest.raises(NegativeDurationError, match=r"maneuver 7: .* >= 0 s, got -0.5 s at gamma 1"):
        walk_motion(library, (1, 2), 1.0)
