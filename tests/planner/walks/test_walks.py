"""Tests of walks in the maneuver automaton."""

import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.errors import UnknownTrimError
from planner.walks.walk import walks


def test_walks_of_up_to_four_trims_are_counted_as_in_table_11() -> None:
    library = thesis_gtmax()
    assert [len(walks(library, trim, max_trims=4)) for trim in range(1, 8)] == [35, 57, 57, 46, 46, 46, 46]


def test_every_step_of_a_walk_is_a_maneuver_of_the_library() -> None:
    library = thesis_kinematic()
    for walk in walks(library, 1, max_trims=4):
        assert len(library.maneuvers_along(walk)) == len(walk) - 1


def test_no_walk_is_listed_twice_and_shorter_ones_come_first() -> None:
    found = walks(thesis_gtmax(), 2, max_trims=5)
    assert len(set(found)) == len(found)
    assert [len(walk) for walk in found] == sorted(len(walk) for walk in found)


def test_a_goal_trim_keeps_only_the_walks_that_end_in_it() -> None:
    library = thesis_gtmax()
    ending = walks(library, 2, max_trims=4, goal_trim=1)
    assert ending
    assert set(ending) == {walk for walk in walks(library, 2, max_trims=4) if walk[-1] == 1}


@pytest.mark.parametrize("trims", [{"start_trim": 9}, {"start_trim": 1, "goal_trim": 9}])
def test_walks_from_or_to_an_unknown_trim_are_refused(trims: dict[str, int]) -> None:
    start = trims["start_trim"]
    with pytest.raises(UnknownTrimError, match=r"no trim 9; the library has \[1, 2, 3, 4, 5, 6, 7\]"):
        walks(thesis_gtmax(), start, max_trims=4, goal_trim=trims.get("goal_trim"))
