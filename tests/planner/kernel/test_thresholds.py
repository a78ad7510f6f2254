"""Both sides of the kernel's thresholds."""

import ctypes
from cmath import exp, phase
from math import inf, pi, sqrt

import pytest

from .native import Chain, Complex, Problem, Stretch, active, native, problem_of
from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel

Doubles = ctypes.c_double * 14
Headings = Complex * 14


@pytest.mark.parametrize(("apart", "same"), [(0.0, 1), (5e-13, 1), (-5e-13, 1), (5e-11, 0), (-5e-11, 0)])
def test_rates_that_only_rounding_tells_apart_share_a_heading(apart: float, same: int) -> None:
    walk = WalkProblem((1, 2, 3, 1), (0.3, 0.3 * (1 + apart), 0.7, 0.3), goal=1.0, heading=1.0)
    problem = problem_of(walk)
    on = active(problem, 0, 1)
    on.bound_heading = 1
    assert native().share_a_heading(ctypes.byref(problem), ctypes.byref(on)) == same
    on.bound_heading = 0
    assert native().share_a_heading(ctypes.byref(problem), ctypes.byref(on)) == 0
    every = active(problem, 0, 2, 3)
    every.bound_heading = 1
    assert native().share_a_heading(ctypes.byref(problem), ctypes.byref(every)) == 0
    straight = problem_of(WalkProblem((1, 2), (0.0, 0.0)))
    on = active(straight, 0, 1)
    on.bound_heading = 1
    assert native().share_a_heading(ctypes.byref(straight), ctypes.byref(on)) == 0


def test_how_slow_a_turn_has_to_be_to_count_as_straight() -> None:
    """By the seconds that are left; before a plan is known, by a million units, and the distance."""
    problem = problem_of(WalkProblem((4, 2, 1), (0.0, -0.3, 0.2)))
    native().set_straight.restype = ctypes.c_double
    assert native().set_straight(ctypes.byref(problem), ctypes.c_double(10.0)) == 0.2
    assert problem.straight == pytest.approx(1e-8 / 1e6, rel=1e-15)
    assert problem.hardly_bent == pytest.approx(1e-5 / (10.0 / 4), rel=1e-15)
    problem.best, problem.fixed = 25.0, 5.0
    assert native().set_straight(ctypes.byref(problem), ctypes.c_double(10.0)) == 0.2
    assert problem.straight == pytest.approx(1e-8 / 20, rel=1e-15)
    assert problem.hardly_bent == pytest.approx(1e-5 / 20, rel=1e-15)
    still = problem_of(WalkProblem((4, 2), (0.0, 0.0)))
    assert native().set_straight(ctypes.byref(still), ctypes.c_double(10.0)) == inf


def test_a_set_of_times_knows_its_turns() -> None:
    walk = WalkProblem((1, 1, 1, 1), (0.5, 0.0, -1e-4, 1e-7))
    problem = problem_of(walk)
    problem.straight, problem.hardly_bent = 1e-6, 2e-6
    found = active(problem, 0, 1, 2)
    assert list(found.place[:4]) == [0, 1, 2, -1]
    assert (found.count, found.turns, found.slowest) == (3, 2, 1e-4)
    assert (found.slow, found.blurred) == (0, 1)
    assert (active(problem, 0).slow, active(problem, 0).blurred) == (0, 0)
    assert (active(problem, 1).slowest, active(problem, 1).turns) == (inf, 0)
    slow = active(problem, 0, 3)
    assert (slow.slow, slow.turns, slow.slowest) == (1, 1, 1e-7)
    straights = native().straights_in
    assert [straights(ctypes.byref(problem), mask) for mask in (0b0001, 0b0010, 0b1010, 0b1111)] == [
        0,
        1,
        2,
        2,
    ]


def test_each_stretch_that_bends_the_cost_down_takes_an_equation() -> None:
    chain = Chain(free=3, straights=0)
    for j in range(3):
        chain.stretch[j].straight = -1
    may_be = native().can_be_least
    assert [bin(choice).count("1") for choice in range(8) if may_be(ctypes.byref(chain), choice)] == [
        0, 1, 1, 2, 1, 2, 2,
    ]  # fmt: skip
    chain.straights = 1
    chain.stretch[1].straight = 4
    assert [choice for choice in range(8) if may_be(ctypes.byref(chain), choice)] == [0, 1, 2, 3, 4, 6]
    chain.straights = 2
    assert [choice for choice in range(8) if may_be(ctypes.byref(chain), choice)] == [0, 2]


def times_of(turned: tuple[float, ...], *, blurred: bool = False, full: int = 0) -> tuple[int, object]:
    """Returns how many times are unclear, and the times, of turns by some angles and a straight coast."""
    rates = [0.5 if k % 2 == 0 else -0.25 for k in range(len(turned))]
    problem = problem_of(WalkProblem((1,) * (len(rates) + 1), (*rates, 0.0)))
    on, heading, angle = active(problem, *range(len(rates) + 1)), Headings(), 0.0
    on.blurred = int(blurred)
    for place, turn in enumerate(turned, start=1):
        angle += turn
        heading[place] = Complex.of(3 * exp(1j * angle))
    straight, times = Doubles(), Doubles()
    straight[len(rates)] = 7.0
    unclear = native().times_of(ctypes.byref(problem), ctypes.byref(on), heading, straight, full, times)
    assert times[len(rates)] == 7.0
    return unclear, list(times[: len(rates)])


def test_a_turn_by_less_than_nothing_is_a_full_one_but_for_that() -> None:
    assert times_of((1.0, -0.5)) == (0, pytest.approx([2.0, 2.0], rel=1e-12))
    assert times_of((-1.0, 0.5)) == (0, pytest.approx([(2 * pi - 1) / 0.5, (2 * pi - 0.5) / 0.25], rel=1e-12))
    assert times_of((-5e-11, 5e-11)) == (0, pytest.approx([2 * pi / 0.5, 2 * pi / 0.25], rel=1e-9))
    # Rounding may have made it less than nothing: then it is either.
    assert times_of((-5e-13, 5e-13)) == (2, pytest.approx([-1e-12, -2e-12], rel=1e-3))
    assert times_of((-5e-13, 5e-13), full=1) == (2, pytest.approx([2 * pi / 0.5, 2 * pi / 0.25], rel=1e-9))
    assert times_of((5e-13, -5e-13)) == (0, pytest.approx([1e-12, 2e-12], rel=1e-3))
    # Near the end of a slow turn's curve there is more of it.
    assert times_of((-1e-8,), blurred=True) == (1, pytest.approx([-2e-8], rel=1e-6))
    assert times_of((-1e-7,), blurred=True) == (0, pytest.approx([2 * pi / 0.5], rel=1e-6))


def proposed(
    walk: WalkProblem, times: tuple[float, ...], *, best: float = inf, slack: float = 1e-9, slow: bool = False
) -> Problem:
    """Returns the problem after some times were proposed without a multiplier."""
    problem = problem_of(walk, slack=slack)
    problem.best = best
    on = active(problem, *range(len(walk.rates)))
    on.slow = int(slow)
    native().propose(ctypes.byref(problem), ctypes.byref(on), Doubles(*times), Complex.of(0))
    return problem


def test_times_are_proposed_that_only_rounding_makes_negative() -> None:
    """Two straight coasts of which the goal needs one: the other is 0, whatever the guess."""
    walk = WalkProblem((1, 1j), (0.0, 0.0), goal=3.0)
    assert proposed(walk, (3.0, -5e-8)).best == pytest.approx(3.0)
    assert proposed(walk, (3.0, -2e-7)).best == inf
    # Turns that are taken as straight lines are corrected by more.
    assert proposed(walk, (3.0, -0.18), slow=True).best == pytest.approx(3.0)
    assert proposed(walk, (3.0, -0.25), slow=True).best == inf
    # A turn's time is as rough as its heading's rounding.
    slow_turn = WalkProblem((1, 1j), (0.0, 1e-6), goal=3.0)
    assert proposed(slow_turn, (3.0, -8e-7)).best == pytest.approx(3.0)
    assert proposed(slow_turn, (3.0, -2e-6)).best == inf


def test_times_are_not_proposed_that_cannot_be_best() -> None:
    walk = WalkProblem((1, 1j), (0.0, 0.0), goal=3 + 1j)
    assert proposed(walk, (3.0 + 5e-7, 1.0), best=4.0 + 1e-12).best == pytest.approx(4.0, abs=1e-13)
    assert proposed(walk, (3.0 + 5e-6, 1.0), best=4.0 + 1e-12).best == 4.0 + 1e-12
    assert proposed(walk, (4.5, 1.0), best=4.0 + 1e-12, slow=True).best == pytest.approx(4.0, abs=1e-13)


def test_a_step_that_is_a_thousand_times_too_long_leads_nowhere() -> None:
    assert proposed(WalkProblem((1,), (0.0,), goal=900.0), (0.5,)).best == pytest.approx(900.0)
    assert proposed(WalkProblem((1,), (0.0,), goal=1200.0), (0.5,)).best == inf
    assert proposed(WalkProblem((1,), (0.0,), goal=1200.0), (5.0,)).best == pytest.approx(1200.0)


def test_an_end_is_as_much_further_inside_as_a_long_way_rounds_it() -> None:
    walk = WalkProblem((1,), (0.0,), goal=1001.0, tolerance=1.0)
    for slack, inside in ((1e-9, 0.0), (1e-13, 1e-11)):
        found = proposed(walk, (1000.0,), slack=slack)
        assert 1.0 - abs(found.times[0] - 1001.0) == pytest.approx(inside, abs=4e-13)
    # No further than to the middle of the tolerance.
    narrow = WalkProblem((1,), (0.0,), goal=1000.0, tolerance=1e-11)
    assert proposed(narrow, (999.9,), slack=1e-13).times[0] == pytest.approx(1000 - 5e-12, abs=4e-13)


@pytest.mark.parametrize("share", [1e-6, 1e-3, 0.05, 0.3, 0.5, 0.89, 0.91, 1 - 1e-6, 1 - 1e-12])
def test_a_heading_is_told_by_what_tells_it_best(share: float) -> None:
    """By u far from the limit, by E near it: where its sine is small, and where its cosine is."""
    one = Stretch(A=Complex.of(2.0), a=1.0, size=2.0, limit=2.0, straight=-1, other=-1)
    native().heading_of.restype = ctypes.c_double
    u, E = 2 * share, 2 * sqrt((1 - share) * (1 + share))
    # What is not told by is off: by the digits that it has lost.
    told = (u, E + 1e-9) if share < 0.5 else (u - 1e-9, E) if share > 0.95 else (u, E)
    found = native().heading_of(ctypes.byref(one), *map(ctypes.c_double, told), 1)
    assert found == pytest.approx(phase(complex(E, u)), rel=1e-12)


def two_circles(one: float, two: float, apart: float, slack: float) -> float:
    native().corner.restype = ctypes.c_double
    return float(native().corner(*map(ctypes.c_double, (one, two, apart, slack))))


def test_a_triangle_may_be_flat_to_the_slack_and_to_the_rounding_of_its_sides() -> None:
    assert two_circles(3.0, 4.0, 5.0, 0.0) == pytest.approx(pi / 2, rel=1e-15)
    assert two_circles(3.0, 4.0, 7.0 + 1e-9, 1e-9) == pi
    assert two_circles(3.0, 4.0, 1.0 - 1e-9, 1.1e-9) == 0.0
    assert two_circles(3.0, 4.0, 7.0 + 2e-9, 1e-9) != two_circles(3.0, 4.0, 7.0 + 2e-9, 1e-9)
    assert two_circles(3.0, 4.0, 1.0 - 2e-9, 1e-9) != two_circles(3.0, 4.0, 1.0 - 2e-9, 1e-9)
    # Radii of 1e9 m are rounded to 1e-7 m.
    assert two_circles(1e9, 1e9, 2e9 + 9.6e-7, 1e-9) == pi
    assert two_circles(1e9, 1e9, 2e9 + 9.6e-6, 1e-9) != two_circles(1e9, 1e9, 2e9 + 9.6e-6, 1e-9)


def line_meets(line: complex, offset: complex, radius: float, slack: float) -> list[float]:
    times = (ctypes.c_double * 2)()
    count = native().meets(
        Complex.of(line), Complex.of(offset), ctypes.c_double(radius), ctypes.c_double(slack), times
    )
    return list(times[:count])


def test_a_line_meets_a_circle_or_passes_it_by_the_slack() -> None:
    assert sorted(line_meets(2, -10 + 3j, 5.0, 0.0)) == pytest.approx([3.0, 7.0])
    assert sorted(line_meets(2, 10 + 3j, 5.0, 0.0)) == pytest.approx([-7.0, -3.0])
    assert line_meets(2, -10 + 5j, 5.0, 0.0) == pytest.approx([5.0, 5.0], rel=1e-15)
    assert line_meets(2, -10 + 5.0000001j, 5.0, 1.1e-7) == pytest.approx([5.0, 5.0])
    assert line_meets(2, -10 + 5.0000001j, 5.0, 0.9e-7) == []
    assert line_meets(0, 1, 5.0, 0.0) == []
    # Nearly a radius away the second root is told to its last digits.
    assert sorted(line_meets(1, 5 + 1e-9, 5.0, 0.0), key=abs)[0] == pytest.approx(-1e-9, rel=1e-6)
    assert len(line_meets(1, 1e9j + 1e9j, 2e9 - 2e-6, 1e-9)) == 2
    assert len(line_meets(1, 1e9j + 1e9j, 2e9 - 2e-5, 1e-9)) == 0
