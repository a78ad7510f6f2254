"""Stretches as functions of u, and the roots of their sum."""

import ctypes
from cmath import exp, phase
from dataclasses import replace
from math import atan2, inf, pi, sqrt

import numpy as np
import pytest

from .native import ActiveSet, Chain, Complex, Problem, Stretch, active, native, problem_of
from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel

STEP = 1e-6


def stretch(*, A: complex, a: float, w: complex = 0j, most: float) -> Stretch:
    """Returns a stretch with known limit, on a curve ending at `most`."""
    size, speed = abs(A), abs(w)
    limit = speed if w else (size / abs(a) if a else inf)
    return Stretch(
        A=Complex.of(A),
        w=Complex.of(w),
        a=a,
        size=size,
        speed=speed,
        limit=limit,
        above=(limit - most) * (limit + most) if limit < inf else 0.0,
        K=(A * w.conjugate()).imag + a * speed * speed if w else 0.0,
        aside=phase(w if w else A),
        straight=0 if w else -1,
        other=-1,
    )


def along(one: Stretch, s: float) -> float:
    return float(native().along(ctypes.byref(one), ctypes.c_double(sqrt(one.above + s * s))))


STRETCHES = {
    "plain": stretch(A=3 - 4j, a=2.0, most=2.0),
    "plain, left": stretch(A=3 - 4j, a=-2.0, most=2.5),
    "plain, at its limit": stretch(A=-1 + 1j, a=0.5, most=abs(-1 + 1j) / 0.5),
    "equal rates": stretch(A=3 - 4j, a=0.0, most=2.0),
    "straight": stretch(A=3 - 4j, a=2.0, w=1 + 2j, most=1.5),
    "straight, at its limit": stretch(A=-3 + 1j, a=-1.0, w=2j, most=2.0),
}


@pytest.mark.parametrize("name", STRETCHES)
@pytest.mark.parametrize("share", [0.05, 0.4, 0.8, 0.99])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_stretch_is_where_its_equation_holds(name: str, share: float, sign: int) -> None:
    """Im(exp(i chi) A) = u a, or Re(exp(i chi) w) = -u."""
    one = STRETCHES[name]
    most = sqrt(one.limit**2 - one.above) if one.limit < inf else 2.0
    u = share * most
    s = sqrt(most**2 - u**2)
    E = sqrt(one.above + s * s)
    A, w = one.A.value, one.w.value
    heading_of = native().heading_of
    heading_of.restype = ctypes.c_double
    chi = heading_of(ctypes.byref(one), ctypes.c_double(u), ctypes.c_double(E), int(sign > 0))
    turned = exp(1j * chi)
    if one.straight >= 0:
        assert (turned * w).real == pytest.approx(-u, abs=1e-9)
        # Stationary in its own heading: the time that its straight coast has.
        time = (u * one.a - (turned * A).imag) / (turned * w).imag
        part = turned * (A + time * w)
    else:
        part = turned * A
    assert part.imag == pytest.approx(u * one.a, abs=1e-9)
    assert part.real == pytest.approx(sign * along(one, s), abs=1e-9)


@pytest.mark.parametrize("name", STRETCHES)
@pytest.mark.parametrize("s", [1e-3, 0.5, 1.4])
def test_how_a_stretch_changes_along_a_curve(name: str, s: float) -> None:
    one = STRETCHES[name]
    slope = native().slope_of(ctypes.byref(one), *map(ctypes.c_double, (sqrt(one.above + s * s), s)))
    difference = (along(one, s + STEP * s) - along(one, s - STEP * s)) / (2 * STEP * s)
    assert slope == pytest.approx(difference, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize(
    ("rate", "headings", "seconds"),
    [
        (0.5, (0.0, 0.1, 1.0, 1.2), (1.0 - 0.1) / 0.5),
        (0.5, (0.1, 0.0, 1.2, 1.0), (1.0 - 0.1) / 0.5),
        (-0.5, (0.0, 0.1, 1.0, 1.2), (2 * pi - 1.2) / 0.5),
        (0.5, (0.0, 0.1, -1.0, -1.2), (2 * pi - 1.3) / 0.5),
        (-0.5, (0.0, 0.1, -1.0, -1.2), 1.0 / 0.5),
        (0.5, (0.0, 0.1, 1.0 + 4 * pi, 1.2 + 4 * pi), 0.9 / 0.5),
        (0.5, (0.0, 0.1, 0.05, 0.2), 0.0),
        (0.5, (0.0, 3.0, 0.5, 4.0), 0.0),
        # Rounding of headings near the end of a curve.
        (0.5, (0.0, 0.0, -2e-8, -2e-8), 0.0),
        (0.5, (0.0, 0.0, -4e-8, -4e-8), 2 * pi / 0.5),
    ],
)
def test_a_turn_between_two_pieces_takes_at_least_that_long(
    rate: float, headings: tuple[float, ...], seconds: float
) -> None:
    found = native().least_turn(*map(ctypes.c_double, (rate, *headings)))
    assert found == (pytest.approx(seconds, abs=1e-6) if seconds else 0.0)


def turning(*, free: int, best: float, last_rate: float = 0.0) -> tuple[Chain, list[object]]:
    problem, on = Problem(best=best, fixed=1.0), ActiveSet(target=0.7)
    chain = Chain(problem=ctypes.pointer(problem), on=ctypes.pointer(on), free=free, last_rate=last_rate)
    for j in range(free):
        chain.stretch[j].rate = (0.5, -0.25)[j]
    return chain, [problem, on]


def too_long(chain: Chain, *headings: float) -> bool:
    values = (ctypes.c_double * 14)(*headings)
    return bool(native().turns_too_long(ctypes.byref(chain), values, values))


def test_turns_are_too_long_where_together_they_take_what_is_allowed() -> None:
    """Turns lead from heading -alpha through each heading to the target."""
    # 1 rad to the right at 0.5 rad/s and 1 rad to the left at 0.25: 6 s beside 1 s in maneuvers.
    assert too_long(turning(free=2, best=7.0 - 1e-6)[0], 1.2, 0.2, 0.2)
    assert not too_long(turning(free=2, best=7.0 + 1e-6)[0], 1.2, 0.2, 0.2)
    # From 1.2 on to 0.2 + 0.7 at -0.1 rad/s: 3 s more.
    assert too_long(turning(free=2, last_rate=-0.1, best=7.0 + 7.0 - 1e-5)[0], 1.2, 0.2 + 1.4, 0.2)
    chain, held = turning(free=1, best=1.0 + 2.0 + 3.0 - 1e-5, last_rate=-0.1)
    assert too_long(chain, 1.2, 0.2)
    chain.problem.contents.best = 1.0 + 2.0 + 3.0 + 1e-5
    assert not too_long(chain, 1.2, 0.2)
    # Straight lines that stand for slow turns take another time.
    chain.problem.contents.best = 1.0
    assert too_long(chain, 1.2, 0.2)
    chain.on.contents.slow = 1
    assert not too_long(chain, 1.2, 0.2)
    assert held


def test_a_series_is_the_sum_near_its_middle() -> None:
    """Third-order series with fourth-order error bound; slopes are the sum's."""
    rng = np.random.default_rng(4)
    native().series.restype = Series
    for _ in range(200):
        chain, signs, held = random_chain(rng)
        most = chain.most
        middle, half = float(rng.uniform(0.2, 0.9)) * most, float(rng.uniform(0.001, 0.1)) * most
        t = native().series(
            ctypes.byref(chain), signs, ctypes.c_double(middle), ctypes.c_double(middle - half)
        )
        for x in np.linspace(-half, half, 7).tolist():
            value, _ = total(chain, signs, middle + x)
            series = t.value + t.slope * x + t.second * x**2 / 2 + t.third * x**3 / 6
            assert abs(value - series) <= t.fourth * x**4 / 24 * (1 + 1e-9) + 1e-13 * t.size
        _, slope = total(chain, signs, middle)
        assert t.slope == pytest.approx(slope, rel=1e-10, abs=1e-12 * t.size / most)
        terms = sum(abs(along(chain.stretch[j], middle)) for j in range(chain.free + 1))
        assert t.size >= terms - 1e-12
        assert (
            t.size
            <= 4 * terms + 10 * sum(abs(chain.stretch[j].K) for j in range(chain.free + 1)) / middle + 1
        )
        assert held


class Series(ctypes.Structure):
    """`Series` of roots.c."""

    _fields_ = tuple(
        (name, ctypes.c_double) for name in ("value", "slope", "second", "third", "fourth", "size")
    )


def random_chain(rng: np.random.Generator) -> tuple[Chain, "ctypes.Array[ctypes.c_double]", list[object]]:
    """Returns stretches that do not close any way, and signs for them."""
    most = float(rng.uniform(1, 3))
    problem = Problem(tolerance=float(rng.choice([0.0, 0.5])), slack=1e-9, best=inf)
    on = ActiveSet()
    chain = Chain(
        problem=ctypes.pointer(problem), on=ctypes.pointer(on), free=int(rng.integers(0, 4)), most=most
    )
    for j in range(chain.free + 1):
        direction = exp(1j * float(rng.uniform(-3, 3)))
        kind = int(rng.integers(0, 4))
        limit = most * float(1.0 if j == 0 else rng.uniform(1.0, 2.0))
        a = float(rng.normal())
        if kind == 0 and j:
            chain.stretch[j] = stretch(A=direction, a=0.0, most=most)
        elif kind == 1:
            A = complex(*rng.normal(size=2))
            chain.stretch[j] = stretch(A=A, a=a, w=limit * direction, most=most)
        else:
            chain.stretch[j] = stretch(A=limit * abs(a) * direction, a=a, most=most)
    signs = (ctypes.c_double * 14)(*rng.choice([-1.0, 1.0], 14))
    return chain, signs, [problem, on]


def total(chain: Chain, signs: "ctypes.Array[ctypes.c_double]", s: float) -> tuple[float, float]:
    slope = ctypes.c_double()
    function = native().sum
    function.restype = ctypes.c_double
    value = function(ctypes.byref(chain), signs, ctypes.c_double(s), ctypes.byref(slope))
    expected = sum(signs[j] * along(chain.stretch[j], s) for j in range(chain.free + 1))
    assert value == pytest.approx(expected - chain.problem.contents.tolerance, abs=1e-12)
    return float(value), float(slope.value)


def test_a_circle_of_the_same_centre_adds_nothing_to_the_way() -> None:
    """Two turns about one centre are interchangeable."""
    walk = WalkProblem((2, 2), (0.5, 0.5), (0j,), (0.0,))
    end, _ = walk.end((1.0, 2.0))
    cost, times = replace(walk, goal=end).solved()
    assert cost == pytest.approx(3.0, abs=1e-9)
    assert sum(times) == pytest.approx(3.0, abs=1e-9)


def test_two_turns_meet_at_the_corner_of_a_triangle() -> None:
    """Circles of 2 and 3 m form a triangle with the goal."""
    walk = WalkProblem((1, 1.5), (0.5, 0.5), (0j,), (pi,))
    for times in ((1.0, 2.0), (4.0, 1.0), (0.5, 5.0)):
        end, _ = walk.end(times)
        assert replace(walk, goal=end).solved()[0] <= sum(times) + 1e-9


def test_a_straight_line_after_a_turn_is_the_tangent() -> None:
    """Right circle of 6 m, then the tangent to a point."""
    walk = WalkProblem((3, 3), (0.5, 0.0), (0j,), (0.0,), goal=10 + 6j)
    _, times = walk.solved()
    assert 3 * times[1] == pytest.approx(sqrt(10**2 - 6**2), abs=1e-9)
    # The radius to where it touches stands across the tangent.
    assert 0.5 * times[0] == pytest.approx(atan2(10, 0) - atan2(8, 6), abs=1e-9)


@pytest.mark.parametrize("aside", [0.0, 1e-9, -1e-8, 1e-7, 1e-6])
def test_a_turn_that_ends_along_the_straight_before_it_is_found(aside: float) -> None:
    walk = WalkProblem((10, 10), (0.0, 0.005), (15 + 1j,), (-0.02,))
    end, _ = walk.end((5.0, 4.0))
    asked = replace(walk, goal=end + 1j * aside, tolerance=0.01)
    assert asked.solved()[0] <= 9.0
    assert active(problem_of(asked), 1).turns == 1
