"""Walks in the maneuver automaton up to a maximum length."""

from flight.automaton.library import Library

Walk = tuple[int, ...]
"""Trim ids; a maneuver of the library joins each two."""


def walks(
    library: Library, start_trim: int, *, max_trims: int, goal_trim: int | None = None
) -> tuple[Walk, ...]:
    """Returns every walk up to a length, shortest first (thesis, 5.4).

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


def count_walks(library: Library, start_trim: int, *, max_trims: int, goal_trim: int | None = None) -> int:
    """Returns the number of walks without listing them.

    Raises:
        UnknownTrimError: the library has no such start or goal trim.
    """
    library.trim(start_trim)
    if goal_trim is not None:
        library.trim(goal_trim)
    ending, count = {start_trim: 1}, int(goal_trim in (None, start_trim))
    for _ in range(max_trims - 1):
        longer: dict[int, int] = {}
        for trim, number in ending.items():
            for after in library.successors(trim):
                longer[after] = longer.get(after, 0) + number
        ending = longer
        count += sum(ending.values()) if goal_trim is None else ending.get(goal_trim, 0)
    return count


def trims_of_walks(
    library: Library, start_trim: int, *, max_trims: int, goal_trim: int | None = None
) -> frozenset[int]:
    """Returns the trims of all walks without listing the walks.

    Raises:
        UnknownTrimError: the library has no such start or goal trim.
    """
    library.trim(start_trim)
    every = {trim.id for trim in library.trims}
    ends = every if goal_trim is None else {library.trim(goal_trim).id}
    onward = {trim: set(library.successors(trim)) for trim in every}
    # Trims that so many steps may lead to, and those from which so many lead to an end.
    reached, left = [{start_trim}], [ends]
    for _ in range(max_trims - 1):
        reached.append({after for trim in reached[-1] for after in onward[trim]})
        left.append(left[-1] | {trim for trim in every if onward[trim] & left[-1]})
    pairs = zip(reached, reversed(left), strict=True)
    return frozenset(trim for there, on in pairs for trim in there & on)
