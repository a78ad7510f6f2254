"""Result of a search."""

from dataclasses import dataclass

from .walk import Walk

Times = tuple[float, ...]
"""Coasting times of a walk, in seconds."""


@dataclass(frozen=True, slots=True)
class SearchResult:
    """The best walk with its coasting times; empty if none was found.

    Attributes:
        walk: trim ids; empty where none was found.
        times: seconds, one tuple for each level.
        costs: seconds, one for each level.
        lower_bound: seconds, of every plan; infinite where it is proved that there is none.
        exhausted: True if every walk was searched exactly, or excluded by a bound.
    """

    walk: Walk
    times: tuple[Times, ...]
    costs: tuple[float, ...]
    lower_bound: float
    exhausted: bool = False
