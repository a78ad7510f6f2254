"""Price-of-robustness example in CasADi (thesis, Problems 4.3 and 4.4)."""

from dataclasses import dataclass
from math import inf
from typing import Any

import casadi

_QUIET: dict[str, Any] = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-12}}


@dataclass(frozen=True, slots=True)
class Optimum:
    """Minimiser of J = x^2 + y^2, with the uncertain a."""

    x: float
    y: float
    a: float
    cost: float


def nominal_example(a: float) -> Optimum:
    """Returns the nominal minimum of J on `y = x + a` (Problem 4.3)."""
    z = casadi.SX.sym("z", 2)
    problem = {"x": z, "f": casadi.sumsqr(z), "g": z[1] - z[0] - a}
    x, y = _solve(problem, [0.0, 0.0], low=[0.0], high=[0.0])
    return Optimum(x, y, a, x**2 + y**2)


def robust_example(a: float, alpha: float) -> Optimum:
    """Returns the largest a at alpha times the nominal cost (Problem 4.4)."""
    z = casadi.SX.sym("z", 3)
    x, y, moved = z[0], z[1], z[2]
    limit = alpha * a**2 / 2
    problem = {"x": z, "f": a - moved, "g": casadi.vertcat(y - x - moved, x**2 + y**2)}
    found = _solve(problem, [-a / 2, a / 2, a], low=[0.0, -inf], high=[0.0, limit])
    return Optimum(found[0], found[1], found[2], found[0] ** 2 + found[1] ** 2)


def _solve(
    problem: dict[str, casadi.SX], start: list[float], *, low: list[float], high: list[float]
) -> list[float]:
    answer = casadi.nlpsol("example", "ipopt", problem, _QUIET)(x0=start, lbg=low, ubg=high)
    return [float(value) for value in answer["x"].nonzeros()]
