"""Safe-stop path to a trim in which the vehicle can wait."""

from heapq import heappop, heappush
from math import hypot

from flight.automaton.library import Library
from flight.automaton.trim import Trim

from .walk import Walk


def rest_trim(library: Library) -> int:
    """Returns the rest trim: hover, else the slowest straight trim.

    Where nothing flies straight, the slowest turn: it stays in a circle.
    """
    return min(library.trims, key=_rest_order).id


def safe_stop_path(library: Library, trim: int) -> Walk:
    """Returns the least-time safe-stop path from a trim, without that trim.

    Empty if the trim is a rest trim, or if no maneuvers lead to one.

    Args:
        library: the automaton.
        trim: id of the trim held.

    Raises:
        UnknownTrimError: the library lacks the trim.
    """
    library.trim(trim)
    goal = rest_trim(library)
    waiting: list[tuple[float, Walk]] = [(0.0, (trim,))]
    done: set[int] = set()
    while waiting:
        time, walk = heappop(waiting)
        if walk[-1] == goal:
            return walk[1:]
        if walk[-1] in done:
            continue
        done.add(walk[-1])
        for after in library.successors(walk[-1]):
            heappush(waiting, (time + library.maneuver(walk[-1], after).duration, (*walk, after)))
    return ()


def _rest_order(trim: Trim) -> tuple[bool, float, int]:
    velocity = trim.velocity
    return velocity.yaw_rate != 0, hypot(velocity.forward, velocity.side), trim.id
