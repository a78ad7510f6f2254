"""The exact search: all candidates of every walk that no bound excludes, in compiled code."""

import ctypes
from functools import cache
from math import inf
from time import perf_counter

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.goal import SLACK
from flight.mission.mission import Mission
from planner.walks.answer import Answer
from planner.walks.goal import goal_seen, wants_heading

from .build import kernel
from .tables import CTable, Table, tables

MOST = 12
"""Trims in a walk, and uncertainty levels, that the kernel has room for."""

NO_LIMIT = 2**62

FORGIVEN = 0.99
"""Of the slack for rounding: what the kernel forgives; the check rounds otherwise."""


class NoKernelError(FlightError):
    """What only compiled code can do in reasonable time was asked for on a machine without a C compiler."""

    def __init__(self) -> None:
        super().__init__("expected a C compiler, one of cc, gcc, clang; there is none that works")


_NUMBERS = (
    "north",
    "east",
    "tolerance",
    "slack",
    "heading",
    "heading_tolerance",
    "heading_slack",
    "seconds",
)


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
        self._library = library
        self._gammas = gammas
        self._prepared = cache(self._prepare)

    def can(self, mission: Mission) -> bool:
        """Whether there is a kernel, and it has room for the mission."""
        return kernel() is not None and mission.max_trims <= MOST and len(self._gammas) <= MOST

    def answer(self, mission: Mission, *, max_nodes: int | None = None, deadline: float = inf) -> Answer:
        """Returns the walk whose worst level is best.

        Args:
            mission: from where to where.
            max_nodes: walks at one level that may be solved; then the best so far is returned, with a bound.
            deadline: seconds after which it is returned likewise, as soon as the walk at hand is solved; the
                time to list the walks of a start trim, once, counts.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        began = perf_counter()
        compiled = kernel()
        assert compiled is not None
        every, structures = self._prepared(mission.start_trim, mission.max_trims, mission.goal_trim)
        found = _Answer()
        most_nodes = NO_LIMIT if max_nodes is None else max_nodes
        seconds = max(deadline - (perf_counter() - began), 0.0)
        task = _task(
            mission, levels=len(self._gammas), tables=len(every), most_nodes=most_nodes, seconds=seconds
        )
        if compiled.search(ctypes.byref(task), structures, ctypes.byref(found)):
            raise MemoryError("the list of walks")
        return self._read(found, every)

    def _prepare(
        self, start_trim: int, max_trims: int, goal_trim: int | None
    ) -> tuple[tuple[Table, ...], "ctypes.Array[CTable]"]:
        every = tables(self._library, self._gammas, start_trim, max_trims, goal_trim)
        structures = (CTable * len(every))()
        for table, structure in zip(every, structures, strict=True):
            table.fill(structure)
        return every, structures

    def _read(self, found: _Answer, every: tuple[Table, ...]) -> Answer:
        exhausted = bool(found.complete)
        if found.walk < 0:
            return Answer((), (), (), found.bound, exhausted)
        walk = tuple(every[found.table].walks[found.walk].tolist())
        levels = range(len(self._gammas))
        times = tuple(tuple(found.times[MOST * level : MOST * level + len(walk)]) for level in levels)
        return Answer(walk, times, tuple(found.costs[: len(levels)]), found.bound, exhausted)


def least_costs_of_each(table: Table, mission: Mission) -> Float[np.ndarray, "walks"]:
    """Returns the exact least cost of each walk of a table in seconds; infinite where it ends elsewhere.

    Args:
        table: of one level.
        mission: from where to where.

    Raises:
        NoKernelError: there is no C compiler.
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
        NoKernelError: there is no C compiler.
    """
    compiled = kernel()
    if compiled is None:
        raise NoKernelError
    structure = CTable()
    table.fill(structure)
    costs, times = np.empty(len(table.walks)), np.zeros(table.walks.shape)
    task = _task(mission, levels=1, tables=1, most_nodes=NO_LIMIT, seconds=inf)
    compiled.each(
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
        mission.tolerance,
        FORGIVEN * mission.destination.slack,
        (mission.goal_heading or 0.0) - start.heading,
        mission.heading_tolerance,
        FORGIVEN * SLACK,
        seconds,
        int(wants_heading(mission)),
        levels,
        tables,
        most_nodes,
    )
