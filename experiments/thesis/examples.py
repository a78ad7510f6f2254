"""Small examples of the thesis: Problems 4.3 and 4.4, appendix B."""

from math import sqrt

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.independent_errors.independent_errors import enumerate_signs
from planner.walks.walk import walks

from .example_problems import nominal_example, robust_example

ALPHA = 1.5
"""Alpha at which Problem 4.4 is compared, with a = 1."""

PRINTED_SLIP = "not reproduced: misprint; the minimum of x^2 + y^2 on y = x + a is a^2/2 at x = -a/2, y = a/2"
MIXED_UP_ROWS = "not reproduced: rows are swapped; 50 m at 0.9, 1 and 1.1 m/s take 55.5556, 50 and 45.4545 s"
MISPRINTED = (
    "not reproduced: misprint; contradicts rows that differ only in the sign of trim 1, which is not held"
)

PROBLEMS = (
    ("problem 4.3, x at a = 1", -0.5, ""),
    ("problem 4.3, y at a = 1", -1.0, PRINTED_SLIP),
    ("problem 4.3, J at a = 1", -1.0, PRINTED_SLIP),
    (f"problem 4.4, x at a = 1, alpha = {ALPHA:g}", -sqrt(ALPHA) / 2, ""),
    (f"problem 4.4, y at a = 1, alpha = {ALPHA:g}", sqrt(ALPHA) / 2, ""),
    (f"problem 4.4, a at a = 1, alpha = {ALPHA:g}", sqrt(ALPHA), ""),
    (f"problem 4.4, J at a = 1, alpha = {ALPHA:g}", ALPHA / 2, ""),
)

ENTERED = "not reproduced: Table 33 was computed with an error of 1.8 m/s for trim 2, as its first row shows"
TABLE_27_ERROR = 0.8
"""Forward error of trim 2 in metres per second, as printed."""

TABLE_31 = {-1: 50.0, 0: 45.4545, 1: 50.0}

TABLE_33 = {
    (-1, -1): 22.7273,
    (-1, 0): 13.6250,
    (-1, 1): 10.1724,
    (0, -1): 22.4545,
    (0, 0): 13.2500,
    (0, 1): 9.7586,
    (1, -1): 22.1818,
    (1, 0): 12.8750,
    (1, 1): 9.3448,
}
"""Seconds by the signs of the maneuver and of trim 2; the sign of trim 1 has no effect, as it is not held."""

MISPRINTS = {(0, 0, 0): 12.0000, (1, 1, 0): 11.6250, (0, 0, -1): 20.1818}
"""Entries of Table 33 that contradict its other rows, by the signs of trim 1, maneuver and trim 2."""


def simple_example() -> tuple[Library, Mission]:
    """Returns Tables 27 and 28 with the trim error of Table 33."""
    trims = (
        Trim(1, "slow forward", Twist(1.0, 0.0, 0.0), Twist(0.1, 0.0, 0.0)),
        Trim(2, "fast forward", Twist(4.0, 0.0, 0.0), Twist(1.8, 0.0, 0.0)),
    )
    faster = Maneuver(2, 1, 2, 2.0, SE2(5.0, 0.0, 0.0), ManeuverError(-0.5, -0.5, 0.0, 0.0))
    library = Library("appendix-b", "", "", trims, (faster,))
    return library, Mission("appendix-b", SE2.identity(), 1, (50.0, 0.0))


def example_rows() -> list[tuple[int, str, float, float, str]]:
    """Returns table (4 for chapter 4), label, printed, computed, explanation."""
    nominal, robust = nominal_example(1.0), robust_example(1.0, ALPHA)
    computed = (nominal.x, nominal.y, nominal.cost, robust.x, robust.y, robust.a, robust.cost)
    rows = [
        (4, what, printed, value, why) for (what, printed, why), value in zip(PROBLEMS, computed, strict=True)
    ]
    library, mission = simple_example()
    error = _entered_error()
    rows.append((27, "error of trim 2, m/s, in Table 33", TABLE_27_ERROR, error, ENTERED))
    rows.append((29, "sequences of at most 2 trims", 2, len(walks(library, 1, max_trims=2)), ""))
    one, two = (
        len(enumerate_signs(library, mission, walk, (0.0,) * len(walk)).scenarios) for walk in ((1,), (1, 2))
    )
    rows += [(30, "scenarios of sequence 1", 3, one, ""), (30, "scenarios of sequence 2", 27, two, "")]
    rows.append((32, "rows: its caption is printed above those of Table 33", 27, two, ""))
    for scenario in enumerate_signs(library, mission, (1,), (50.0,)).scenarios:
        (sign,) = scenario.signs
        rows.append((31, f"sign {sign}", TABLE_31[sign], scenario.cost, MIXED_UP_ROWS))
    for scenario in enumerate_signs(library, mission, (1, 2), (0.0, 0.0)).scenarios:
        slow, change, fast = scenario.signs
        printed = MISPRINTS.get((slow, change, fast), TABLE_33[change, fast])
        why = MISPRINTED if scenario.signs in MISPRINTS else ""
        rows.append((33, f"signs {slow} {change} {fast}", printed, scenario.cost, why))
    return rows


def _entered_error() -> float:
    """Returns trim 2's forward error in Table 33's first row, m/s.

    All signs are negative there: the maneuver takes 2.5 s and covers 5.5 of the 50 m, and the rest is flown
    at 4 m/s minus the error.
    """
    return 4.0 - (50.0 - 5.5) / (TABLE_33[-1, -1] - 2.5)
