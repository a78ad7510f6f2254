"""The sign convention of errors, held to the thesis's Table 10."""

from dataclasses import replace

import pytest

import libraries
from flight.automaton.library_file import read_library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.sign_convention import signed_maneuver_error, signed_trim_error
from flight.automaton.trim import Trim
from flight.se2 import Twist

GTMAX = read_library(libraries.FOLDER / "thesis-gtmax.json")


@pytest.mark.parametrize("maneuver", GTMAX.maneuvers, ids=lambda maneuver: f"row {maneuver.id}")
def test_table_10_follows_the_convention(maneuver: Maneuver) -> None:
    left, reached = GTMAX.trim(maneuver.from_trim), GTMAX.trim(maneuver.to_trim)
    signed = signed_maneuver_error(maneuver.error, left=left.velocity, reached=reached.velocity)
    if maneuver.id == 11:  # the one row whose lateral error does not
        assert signed == replace(maneuver.error, side=-maneuver.error.side)
    else:
        assert signed == maneuver.error


@pytest.mark.parametrize("trim", GTMAX.trims, ids=lambda trim: trim.name)
def test_table_9_follows_the_convention(trim: Trim) -> None:
    assert signed_trim_error(trim.error, trim.velocity) == trim.error


def test_signs_do_not_depend_on_the_signs_of_the_sizes() -> None:
    left, reached = Twist(3.0, 0.0, 0.1), Twist(1.0, 0.0, 0.4)
    sizes = [ManeuverError(s * 0.5, s * 1.0, s * 0.2, s * 0.1) for s in (1, -1)]
    signed = [signed_maneuver_error(size, left=left, reached=reached) for size in sizes]
    assert signed[0] == signed[1] == ManeuverError(-0.5, -1.0, -0.2, 0.1)


def test_a_left_turn_mirrors_a_right_turn() -> None:
    size = ManeuverError(0.5, 1.0, 0.2, 0.1)
    signed = signed_maneuver_error(size, left=Twist(3.0, 0.0, -0.1), reached=Twist(1.0, 0.0, -0.4))
    assert signed == ManeuverError(-0.5, -1.0, 0.2, -0.1)
