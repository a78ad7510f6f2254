"""Which trims may follow one another: the walks in the maneuver automaton, up to a depth."""

from flight.library import Library

Walk = tuple[int, ...]
"""Trim ids; a maneuver of the library joins each two."""


def walks(
    library: Library, start_trim: int, *, max_trims: int, goal_trim: int | None = None
) -> tuple[Walk, ...]:
    """Returns every walk of at most so many trims, shorter ones first (thesis, 5.4 and Table 11).

    Trims may be visited again.

    Args:
        library: the automaton.
        start_trim: id of the first trim.
        max_trims: largest number of trims in a walk.
        goal_trim: id of the last trim; None leaves it free.

    Raises:
        UnknownTrimError: the library has no such start or goal trim.
    """
    library.trim(start_trim)
    if goal_trim is not None:
        library.trim(goal_trim)
    longest: list[Walk] = [(start_trim,)]
    found = list(longest)
    for _ in range(max_trims - 1):
        longest = [(*walk, trim) for walk in longest for trim in library.successors(walk[-1])]
        found += longest
    return tuple(walk for walk in found if goal_trim in (None, walk[-1]))
