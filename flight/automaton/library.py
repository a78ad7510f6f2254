"""Motion-primitive library: the maneuver automaton with its numbers."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from itertools import pairwise
from typing import Annotated, Any

from pydantic import Field, GetPydanticSchema, JsonValue, WithJsonSchema

from flight.errors import FlightError, NoManeuverError, UnknownTrimError
from flight.file_value import FileValue, InForm
from flight.schema import json_content, schema_named

from .conditions import Conditions
from .maneuver import Maneuver, ManeuverRow
from .statistics import InterpolationClaim
from .trim import Trim

SCHEMA = "maneuver-library/1"

_Json = Annotated[Any, GetPydanticSchema(lambda _, handler: handler(JsonValue))]


class InconsistentLibraryError(FlightError):
    """A library contradicts itself."""


@dataclass(frozen=True)
class Library(FileValue):
    """Trims joined by maneuvers (thesis, 2.4), immutable and consistent by construction.

    Attributes:
        schema: of its file.
        name: short name, also the file's.
        description: one sentence for people.
        vehicle: name of the vehicle.
        conditions: flight conditions for which the numbers are valid.
        provenance: origin of the numbers, as plain JSON values.
        trims: vertices, unique ids.
        maneuvers: edges, unique ids, at most one for each ordered pair of trims.

    Raises:
        InconsistentLibraryError: two primitives share an id, a maneuver joins an unknown trim, two
            maneuvers join the same trims, or there is no trim.
    """

    schema: Annotated[str, schema_named(SCHEMA), WithJsonSchema({"const": SCHEMA})] = field(
        init=False, default=SCHEMA, repr=False
    )
    name: str
    description: str
    vehicle: str
    conditions: Conditions = field(default_factory=Conditions, kw_only=True)
    provenance: Mapping[str, _Json] = field(default_factory=dict, kw_only=True)
    trims: Annotated[tuple[Trim, ...], Field(min_length=1)]
    maneuvers: tuple[Annotated[Maneuver, InForm(ManeuverRow, ManeuverRow.maneuver, ManeuverRow.of)], ...]

    def __post_init__(self) -> None:
        """Refuses a library that contradicts itself."""
        if not self.trims:
            raise InconsistentLibraryError("trims: expected at least one, got none")
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
                f"conditions.maneuver_end.band: expected one for each of the trims {sorted(self._trims)}, "
                f"got {sorted(rule.bands)}"
            )

    @property
    def text(self) -> str:
        """Text of its file: numbers round-trip exactly, equal libraries give equal bytes."""
        return json.dumps(json_content(self), indent=2, ensure_ascii=False, allow_nan=False) + "\n"

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of its text, as hexadecimal digits; worked out once."""
        return sha256(self.text.encode()).hexdigest()

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
        """Claim for each interpolated primitive; empty where all were flown."""
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
        """Returns the trims that one maneuver reaches, in the library's order."""
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
