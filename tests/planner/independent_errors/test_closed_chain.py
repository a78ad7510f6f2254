"""Tests of chain closures: closed on the goal within bounded time."""

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax
from flight.mission.mission import Mission
from flight.se2 import SE2
from planner.independent_errors.closure import Closure, ClosureTimes, close_chain, closures_of
from planner.independent_errors.error_path import ErrorPath, error_path
from planner.kernel.exact import best_times
from tests.support.planning.wandering import wandering

DRAWS = 40

Boxes = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Middles, half widths, coasting times."""


def boxes(rng: np.random.Generator, path: ErrorPath, count: int, size: float) -> Boxes:
    variables = len(path.names)
    width = size * rng.uniform(0.2, 1, (count, variables))
    middle = (1 - width) * rng.uniform(-1, 1, (count, variables))
    times = rng.uniform(0.5, 6.0, (count, len(path.walk)))
    return middle, width, times


def solved(
    path: ErrorPath, errors: np.ndarray, times: np.ndarray, closure: Closure, wanted: np.ndarray
) -> np.ndarray:
    """Returns Newton-corrected times that end at a point."""
    answering = list(closure.answering)
    times = times.copy()
    for _ in range(30):
        off = wanted - ends(path, errors, times)[:, : len(answering)]
        slope = np.empty((len(errors), len(answering), len(answering)))
        for column, place in enumerate(answering):
            step = np.zeros(times.shape)
            step[:, place] = 1e-6
            more, less = (ends(path, errors, times + sign * step) for sign in (1, -1))
            slope[:, :, column] = (more - less)[:, : len(answering)] / 2e-6
        times[:, answering] += np.linalg.solve(slope, off[:, :, None])[:, :, 0]
    return times


def ends(path: ErrorPath, errors: np.ndarray, times: np.ndarray) -> np.ndarray:
    numbers = path.at(errors)
    end = numbers.end(times)
    heading = (numbers.rate * times).sum(axis=1) + numbers.turn.sum(axis=1)
    return np.stack([end.real, end.imag, heading], axis=1)


def check_draws(path: ErrorPath, drawn: Boxes, closure: Closure, closed: ClosureTimes) -> int:
    """Asserts that drawn errors are compensated; returns the closed boxes."""
    middle, width, times = drawn
    rng, variables = np.random.default_rng(5), middle.shape[1]
    aims = ends(path, middle, times)[:, : len(closure.answering)]
    for box in np.flatnonzero(closed.holds).tolist():
        d = rng.uniform(-1, 1, (DRAWS, variables))
        d[: DRAWS // 2] = np.sign(d[: DRAWS // 2])
        errors = middle[box] + d * width[box]
        start = np.tile(times[box], (DRAWS, 1))
        for place, time in closed.times.items():
            start[:, place] = time.middle[box] + d @ time.slope[box, :variables]
        exact = solved(path, errors, start, closure, np.tile(aims[box], (DRAWS, 1)))
        np.testing.assert_allclose(
            ends(path, errors, exact)[:, : len(closure.answering)], aims[[box] * DRAWS], atol=1e-7
        )
        for place, time in closed.times.items():
            own = np.abs(time.slope[box, variables:]).sum() + time.radius[box]
            assert (np.abs(exact[:, place] - start[:, place]) <= own + 1e-7).all()
        seconds = path.at(errors).fixed + exact.sum(axis=1)
        assert (seconds <= closed.seconds.high[box] + 1e-7).all()
        facing = ends(path, errors, exact)[:, 2]
        off = facing - closed.heading.middle[box]
        off -= 2 * np.pi * np.round(off / (2 * np.pi))
        assert (np.abs(off) <= closed.heading.reach[box] + 1e-7).all()
    return int(closed.holds.sum())


@pytest.mark.parametrize("turns", ["stst", "tst", "tts", "sst", "stts", "ttt"])
@pytest.mark.parametrize("each", ["primitive", "scalar"])
def test_times_that_claim_to_close_the_walk_do(turns: str, each: str) -> None:
    rng = np.random.default_rng(len(turns) * 7 + turns.count("t"))
    claimed: dict[Closure, int] = {}
    for _ in range(2):
        path = error_path(wandering(rng, turns), tuple(range(1, len(turns) + 1)), 1.0, each)  # type: ignore[arg-type]
        for closure in closures_of(path, heading=True, tolerance=0.0):
            if closure.turn is None and not closure.others:
                continue  # No adjusted time moves the end.
            middle, width, times = boxes(rng, path, 12, rng.choice([0.03, 0.2, 0.5]))
            goal = path.at(middle).end(times)
            closed = close_chain(path, middle, width, times, goal=goal, tolerance=0.0, closure=closure)
            claimed[closure] = claimed.get(closure, 0) + check_draws(
                path, (middle, width, times), closure, closed
            )
    assert all(count > 0 for count in claimed.values()), claimed


@pytest.mark.parametrize("turns", ["s", "t", "ts", "sts"])
def test_one_coast_or_none_ends_in_the_disc(turns: str) -> None:
    rng, tolerance = np.random.default_rng(2), 1.5
    claimed: dict[Closure, int] = {}
    for _ in range(8):
        path = error_path(wandering(rng, turns), tuple(range(1, len(turns) + 1)), 1.0, "scalar")
        for closure in closures_of(path, heading=False, tolerance=tolerance):
            if closure.turn is not None or len(closure.others) == 2:
                continue
            middle, width, times = boxes(rng, path, 12, rng.choice([0.03, 0.1, 0.3]))
            aside = rng.uniform(0.1, 1.0) if closure.answering else 0.3
            goal = path.at(middle).end(times) + tolerance * aside * np.exp(1j * rng.uniform(0, 7, 12))
            if closure.answering:
                times[:, closure.answering[0]] = entered(
                    path, middle, times, closure.answering[0], (goal, tolerance)
                )
            closed = close_chain(path, middle, width, times, goal=goal, tolerance=tolerance, closure=closure)
            for box in np.flatnonzero(closed.holds).tolist():
                d = rng.uniform(-1, 1, (DRAWS, middle.shape[1]))
                errors, held = middle[box] + d * width[box], np.tile(times[box], (DRAWS, 1))
                for place, time in closed.times.items():
                    held[:, place] = time.middle[box] + d @ time.slope[box, : middle.shape[1]]
                    own = np.abs(time.slope[box, middle.shape[1] :]).sum() + time.radius[box]
                    exact = entered(path, errors, held, place, (np.tile(goal[box], DRAWS), tolerance))
                    assert (np.abs(exact - held[:, place]) <= own + 1e-7).all()
                    held[:, place] = exact
                assert (np.abs(path.at(errors).end(held) - goal[box]) <= tolerance + 1e-7).all()
            claimed[closure] = claimed.get(closure, 0) + int(closed.holds.sum())
    assert all(count > 0 for count in claimed.values()), claimed


def entered(
    path: ErrorPath, errors: np.ndarray, times: np.ndarray, place: int, disc: tuple[np.ndarray, float]
) -> np.ndarray:
    """Returns Newton-corrected times of entry into a disc."""
    goal, tolerance = disc
    times = times.copy()

    def miss(shift: float) -> np.ndarray:
        moved = times.copy()
        moved[:, place] += shift
        off: np.ndarray = np.abs(path.at(errors).end(moved) - goal)
        return off

    for _ in range(60):
        slope = (miss(1e-6) - miss(-1e-6)) / 2e-6
        times[:, place] += np.clip((tolerance - miss(0.0)) / np.where(slope == 0, 1.0, slope), -0.5, 0.5)
    return times[:, place]


@pytest.mark.parametrize("walk", [(2, 5, 7, 3), (2, 5), (3, 6, 3)])
def test_trims_are_held_at_least_as_long_as_asked(walk: tuple[int, ...]) -> None:
    rng = np.random.default_rng(8)
    path = error_path(thesis_gtmax(), walk, 1.0, "scalar")
    for _ in range(20):
        errors = rng.uniform(-1, 1, (1, len(path.names)))
        least, more = rng.uniform(0, 4, (1, len(walk))), rng.uniform(0, 3, (1, len(walk)))
        goal = complex(path.at(errors).end(least + more)[0])
        mission = Mission("there", SE2.identity(), walk[0], (goal.real, goal.imag), tolerance=0.5)
        cost, times = best_times(path.table(errors, least), mission)
        assert abs(path.at(errors).end(least + times)[0] - goal) <= 0.5 + 1e-9
        assert cost[0] == pytest.approx(path.at(errors).fixed[0] + (least + times).sum())
        assert cost[0] <= path.at(errors).fixed[0] + (least + more).sum() + 1e-9
