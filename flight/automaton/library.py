"""A motion-primitive library: the maneuver automaton with the numbers of its vertices and edges."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any

from flight.errors import FlightError, NoManeuverError, UnknownTrimError

from .conditions import Conditions
from .maneuver import Maneuver
from .statistics import InterpolationClaim
from .trim import Trim


class InconsistentLibraryError(FlightError):
    """A library contradicts itself; says where."""


@dataclass(frozen=True)
class Library:
    """Trims joined by maneuvers (thesis, 2.4), immutable and consistent by construction.

    Attributes:
        name: short name, also the file's.
        description: one sentence for people.
        vehicle: what was flown.
        trims: vertices, unique ids.
        maneuvers: edges, unique ids, at most one for each ordered pair of trims.
        conditions: where the numbers hold.
        provenance: where they come from, as plain JSON values.

    Raises:
        InconsistentLibraryError: two primitives share an id, a maneuver joins an unknown trim, two
            maneuvers join the same trims, or there is no trim.
    """

    name: str
    description: str
    vehicle: str
    trims: tuple[Trim, ...]
    maneuvers: tuple[Maneuver, ...]
    conditions: Conditions = field(default_factory=Conditions)
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Refuses a library that contradicts itself."""
        if not self.trims:
            raise InconsistentLibraryError("trims: a library has at least one trim, got none")
        _check_unique_ids("trims", [trim.id for trim in self.trims])
        _check_unique_ids("maneuvers", [maneuver.id for maneuver in self.maneuvers])
        edges: dict[tuple[int, int], int] = {}
        for place, maneuver in enumerate(self.maneuvers):
            for end, trim in (("from", maneuver.from_trim), ("to", maneuver.to_trim)):
                if trim not in self._trims:
                    raise InconsistentLibraryError(
                        f"maneuvers[{place}].{end}: no trim {trim}; the library has {sorted(self._trims)}"
                    )
            edge = maneuver.from_trim, maneuver.to_trim
            if edge in edges:
                raise InconsistentLibraryError(
                    f"maneuvers[{place}]: maneuvers {edges[edge]} and {maneuver.id} both lead "
                    f"from trim {edge[0]} to trim {edge[1]}"
                )
            edges[edge] = maneuver.id
        self._check_bands()

    def _check_bands(self) -> None:
        rule = self.conditions.maneuver_end
        if rule is not None and set(rule.bands) != set(self._trims):
            raise InconsistentLibraryError(
                f"conditions.maneuver_end.band: one band for each of the trims {sorted(self._trims)}, "
                f"got {sorted(rule.bands)}"
            )

    @cached_property
    def _trims(self) -> dict[int, Trim]:
        return {trim.id: trim for trim in self.trims}

    @cached_property
    def _maneuvers(self) -> dict[int, dict[int, Maneuver]]:
        edges: dict[int, dict[int, Maneuver]] = {trim.id: {} for trim in self.trims}
        for maneuver in self.maneuvers:
            edges[maneuver.from_trim][maneuver.to_trim] = maneuver
        return edges

    @property
    def interpolated(self) -> tuple[InterpolationClaim, ...]:
        """What is claimed of each primitive whose errors were interpolated; empty where all were flown."""
        claims = [trim.interpolated for trim in self.trims] + [row.interpolated for row in self.maneuvers]
        return tuple(claim for claim in claims if claim is not None)

    def trim(self, trim_id: int) -> Trim:
        """Returns the trim with this id.

        Raises:
            UnknownTrimError: there is none.
        """
        try:
            return self._trims[trim_id]
        except KeyError:
            raise UnknownTrimError(trim_id, self._trims) from None

    def maneuver(self, from_trim: int, to_trim: int) -> Maneuver:
        """Returns the maneuver that joins two trims.

        Raises:
            UnknownTrimError: one of the trims does not exist.
            NoManeuverError: nothing joins them.
        """
        self.trim(to_trim)
        reachable = self._maneuvers[self.trim(from_trim).id]
        try:
            return reachable[to_trim]
        except KeyError:
            raise NoManeuverError(from_trim, to_trim, reachable) from None

    def successors(self, trim_id: int) -> tuple[int, ...]:
        """Returns the ids of the trims that one maneuver reaches, in the library's order."""
        return tuple(self._maneuvers[self.trim(trim_id).id])

    def maneuvers_along(self, trims: Iterable[int]) -> tuple[Maneuver, ...]:
        """Returns the maneuvers of a walk through the given trims."""
        walk = tuple(trims)
        return tuple(self.maneuver(a, b) for a, b in pairwise(walk))


def _check_unique_ids(kind: str, ids: list[int]) -> None:
    for place, number in enumerate(ids):
        if number in ids[:place]:
            raise InconsistentLibraryError(
                f"{kind}[{place}].id: {number} is taken by {kind}[{ids.index(number)}]"
            )
