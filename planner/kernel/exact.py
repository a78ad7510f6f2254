"""Exact search over every walk not excluded by a bound, in C."""

import ctypes
from math import inf

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.mission.destination import SLACK
from flight.mission.mission import Mission
from planner.walks.goal_condition import goal_from_start, wants_heading
from planner.walks.search_result import SearchResult
from planner.walks.walk import Walk

from .automaton import Automaton
from .build import load_kernel
from .tables import CTable, KernelTable

MOST_TRIMS = 12
"""Trims in a walk, and uncertainty levels, that the kernel has room for."""

NO_LIMIT = 2**62

SHARE_OF_SLACK = 0.99
"""Share of the slack for rounding that the kernel uses; the check rounds otherwise."""


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
        *(
            (name, ctypes.c_long)
            for name in ("wants_heading", "start_trim", "goal_trim", "max_trims", "most_nodes")
        ),
    )


class _Answer(ctypes.Structure):
    _fields_ = (
        ("cost", ctypes.c_double),
        ("bound", ctypes.c_double),
        ("times", ctypes.c_double * (MOST_TRIMS * MOST_TRIMS)),
        ("costs", ctypes.c_double * MOST_TRIMS),
        ("trims", ctypes.c_long),
        ("walk", ctypes.c_long * MOST_TRIMS),
        ("nodes", ctypes.c_long),
        ("complete", ctypes.c_long),
    )


class ExactSearch:
    """Finds the best walk of one library over some uncertainty levels.

    Args:
        library: the primitives.
        gammas: the levels.
    """

    def __init__(self, library: Library, gammas: tuple[float, ...]) -> None:
        if len(gammas) > MOST_TRIMS:
            raise ValueError(f"expected at most {MOST_TRIMS} levels, got {len(gammas)}")
        self._library = library
        self._gammas = gammas
        self._automaton = Automaton.of(library, gammas)
        self._structure, self._arrays = self._automaton.structure()

    def answer(
        self, mission: Mission, *, max_nodes: int | None = None, deadline: float = inf
    ) -> SearchResult:
        """Returns the walk of least worst-case cost.

        Args:
            mission: from where to where.
            max_nodes: walks at one level that may be solved; then the best so far is returned, with a bound.
            deadline: seconds after which it is returned likewise.

        Raises:
            NoMachineCodeError: there is no C compiler that works.
            UnknownTrimError: the library lacks the start or goal trim.
        """
        found = _Answer()
        task = self._task(mission, max_nodes=max_nodes, deadline=deadline)
        if load_kernel().search(ctypes.byref(task), ctypes.byref(self._structure), ctypes.byref(found)):
            raise MemoryError("the search for walks")
        return self._read(found)

    def promising_walks(
        self, mission: Mission, *, limit: float, most: int, deadline: float = inf
    ) -> tuple[tuple[Walk, ...], float]:
        """Returns walks of least bound, and a bound of the others.

        Args:
            mission: from where to where.
            limit: seconds; walks that take longer are of no interest.
            most: walks to return.
            deadline: seconds after which the walks so far are returned.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        task = self._task(mission, max_nodes=None, deadline=deadline)
        trims, lengths = np.empty((most, MOST_TRIMS), dtype=np.int_), np.empty(most, dtype=np.int_)
        rest = ctypes.c_double()
        count = load_kernel().list_walks(
            ctypes.byref(task),
            ctypes.byref(self._structure),
            ctypes.c_double(limit),
            ctypes.c_long(most),
            ctypes.c_void_p(trims.ctypes.data),
            ctypes.c_void_p(lengths.ctypes.data),
            ctypes.byref(rest),
        )
        if count < 0:
            raise MemoryError("the search for walks")
        found = zip(trims[:count], lengths[:count].tolist(), strict=True)
        return tuple(tuple(self._automaton.ids[row[:length]].tolist()) for row, length in found), rest.value

    def _task(self, mission: Mission, *, max_nodes: int | None, deadline: float) -> _Task:
        if mission.max_trims > MOST_TRIMS:
            raise ValueError(f"max_trims must be <= {MOST_TRIMS}, got {mission.max_trims}")
        self._library.trim(mission.start_trim)
        if mission.goal_trim is not None:
            self._library.trim(mission.goal_trim)
        return _task(mission, max_nodes=max_nodes, seconds=deadline, automaton=self._automaton)

    def _read(self, found: _Answer) -> SearchResult:
        exhausted = bool(found.complete)
        if not found.trims:
            return SearchResult((), (), (), found.bound, exhausted)
        walk = tuple(self._automaton.ids[found.walk[: found.trims]].tolist())
        levels = range(len(self._gammas))
        times = tuple(
            tuple(found.times[MOST_TRIMS * level : MOST_TRIMS * level + len(walk)]) for level in levels
        )
        return SearchResult(walk, times, tuple(found.costs[: len(levels)]), found.bound, exhausted)


def least_costs(table: KernelTable, mission: Mission) -> Float[np.ndarray, "walks"]:
    """Returns each walk's exact least cost in seconds; infinite if infeasible.

    Args:
        table: of one level.
        mission: from where to where.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    return best_times(table, mission)[0]


def best_times(
    table: KernelTable, mission: Mission
) -> tuple[Float[np.ndarray, "walks"], Float[np.ndarray, "walks trims"]]:
    """Returns each walk's exact least cost and coasting times, in seconds.

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
    task = _task(mission)
    load_kernel().each(
        ctypes.byref(task),
        ctypes.byref(structure),
        ctypes.c_void_p(costs.ctypes.data),
        ctypes.c_void_p(times.ctypes.data),
    )
    return costs, times


def _task(
    mission: Mission,
    *,
    max_nodes: int | None = None,
    seconds: float = inf,
    automaton: Automaton | None = None,
) -> _Task:
    start = mission.start
    goal = goal_from_start(mission)
    return _Task(
        goal.real,
        goal.imag,
        mission.tolerance,
        SHARE_OF_SLACK * mission.destination.slack,
        (mission.goal_heading or 0.0) - start.heading,
        mission.heading_tolerance,
        SHARE_OF_SLACK * SLACK,
        seconds,
        int(wants_heading(mission)),
        automaton.place(mission.start_trim) if automaton else 0,
        automaton.place(mission.goal_trim) if automaton and mission.goal_trim is not None else -1,
        mission.max_trims,
        NO_LIMIT if max_nodes is None else max_nodes,
    )
