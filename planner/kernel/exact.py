"""The exact search: all candidates of every walk that no bound excludes, in compiled code."""

import ctypes
from functools import cache
from math import inf
from time import perf_counter

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.walks.answer import Answer
from planner.walks.goal import goal_seen, wants_heading

from .build import kernel
from .tables import CTable, Table, tables

MOST = 12
"""Trims in a walk, and uncertainty levels, that the kernel has room for."""

NO_LIMIT = 2**62

EQUALITY = 1e-6
"""Metres, radians: a tolerance up to this means equality."""

INSIDE = 1e-9
"""Metres: how far inside a tolerance the kernel aims; twice what it forgives."""

HEADING_INSIDE = 1e-12
"""Radians, likewise. A heading to be met exactly is met to within what counts as equal: over long ways each
millionth of a radian is worth milliseconds."""

EQUAL_TURNS = 2
"""With a heading wanted, more coasts at the same rate may leave a freedom that no candidate shows."""


_NUMBERS = ("north", "east", "tolerance", "heading", "heading_tolerance", "seconds")


class _Task(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_double) for name in _NUMBERS),
        *((name, ctypes.c_long) for name in ("wants_heading", "levels", "tables", "most_nodes")),
    )


class _Answer(ctypes.Structure):
    _fields_ = (
        ("cost", ctypes.c_double),
        ("bound", ctypes.c_double),
        ("least", ctypes.c_double),
        ("times", ctypes.c_double * (MOST * MOST)),
        ("costs", ctypes.c_double * MOST),
        *((name, ctypes.c_long) for name in ("table", "walk", "nodes", "complete")),
    )


class ExactSearch:
    """Finds the best walk of one library over some uncertainty levels.

    Args:
        library: the primitives.
        gammas: the levels.
    """

    def __init__(self, library: Library, gammas: tuple[float, ...]) -> None:
        if len(gammas) > MOST:
            raise ValueError(f"expected at most {MOST} levels, got {len(gammas)}")
        self._library = library
        self._gammas = gammas
        self._prepared = cache(self._prepare)

    def answer(self, mission: Mission, *, max_nodes: int | None = None, deadline: float = inf) -> Answer:
        """Returns the walk whose worst level is best.

        Args:
            mission: from where to where.
            max_nodes: walks at one level that may be solved; then the best so far is returned, with a bound.
            deadline: seconds after which it is returned likewise, as soon as the walk at hand is solved; the
                time to list the walks of a start trim, once, counts.

        Raises:
            NoMachineCodeError: there is no C compiler that works.
            UnknownTrimError: the library lacks the start or goal trim.
        """
        if mission.max_trims > MOST:
            raise ValueError(f"max_trims must be <= {MOST}, got {mission.max_trims}")
        began = perf_counter()
        every, structures = self._prepared(mission.start_trim, mission.max_trims, mission.goal_trim)
        found = _Answer()
        most_nodes = NO_LIMIT if max_nodes is None else max_nodes
        seconds = max(deadline - (perf_counter() - began), 0.0)
        task = _task(
            mission, levels=len(self._gammas), tables=len(every), most_nodes=most_nodes, seconds=seconds
        )
        if kernel().search(ctypes.byref(task), structures, ctypes.byref(found)):
            raise MemoryError("the list of walks")
        return self._read(found, every, mission)

    def _prepare(
        self, start_trim: int, max_trims: int, goal_trim: int | None
    ) -> tuple[tuple[Table, ...], "ctypes.Array[CTable]"]:
        every = tables(self._library, self._gammas, start_trim, max_trims, goal_trim)
        structures = (CTable * len(every))()
        for table, structure in zip(every, structures, strict=True):
            table.fill(structure)
        return every, structures

    def _read(self, found: _Answer, every: tuple[Table, ...], mission: Mission) -> Answer:
        hidden = wants_heading(mission) and any(table.equal_turns > EQUAL_TURNS for table in every)
        exhausted = bool(found.complete) and not hidden
        bound = found.least if hidden else found.bound
        if found.walk < 0:
            return Answer((), (), (), inf if exhausted else bound, exhausted)
        walk = tuple(every[found.table].walks[found.walk].tolist())
        levels = range(len(self._gammas))
        times = tuple(tuple(found.times[MOST * level : MOST * level + len(walk)]) for level in levels)
        return Answer(walk, times, tuple(found.costs[: len(levels)]), bound, exhausted)


def least_costs_of_each(table: Table, mission: Mission) -> Float[np.ndarray, "walks"]:
    """Returns the exact least cost of each walk of a table in seconds; infinite where it ends elsewhere.

    Args:
        table: of one level.
        mission: from where to where.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    return best_of_each(table, mission)[0]


def best_of_each(
    table: Table, mission: Mission
) -> tuple[Float[np.ndarray, "walks"], Float[np.ndarray, "walks trims"]]:
    """Returns the exact least cost of each walk of a table, and its coasting times, in seconds.

    Where a walk cannot end at the goal its cost is infinite and its times are 0.

    Args:
        table: of one level.
        mission: from where to where.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    structure = CTable()
    table.fill(structure)
    costs, times = np.empty(len(table.walks)), np.zeros(table.walks.shape)
    task = _task(mission, levels=1, tables=1, most_nodes=NO_LIMIT, seconds=inf)
    kernel().each(
        ctypes.byref(task),
        ctypes.byref(structure),
        ctypes.c_void_p(costs.ctypes.data),
        ctypes.c_void_p(times.ctypes.data),
    )
    return costs, times


def _task(mission: Mission, *, levels: int, tables: int, most_nodes: int, seconds: float) -> _Task:
    start = mission.start
    goal = goal_seen(mission)
    return _Task(
        goal.real,
        goal.imag,
        _aimed(mission.tolerance),
        (mission.goal_heading or 0.0) - start.heading,
        max(mission.heading_tolerance, EQUALITY) - HEADING_INSIDE,
        seconds,
        int(wants_heading(mission)),
        levels,
        tables,
        most_nodes,
    )


def _aimed(tolerance: float) -> float:
    """Returns what the kernel aims at: further inside the tolerance than rounding; 0 for equality."""
    return tolerance - INSIDE if tolerance > EQUALITY else 0.0
