"""The errors of a library over those of another, entry by entry: whether they are of the same order."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from flight.library import Library

from .promise import maneuver_box, trim_box
from .samples import MANEUVER_SCALARS, TRIM_SCALARS

SAME_ORDER = (0.25, 4.0)
"""Ratios inside are of the same order."""

# Metres per second and radians per second: trims whose velocities differ by less are the same.
_SAME_VELOCITY = 1e-3


@dataclass(frozen=True, slots=True)
class ErrorRatio:
    """One absolute error beside the other library's, in SI units.

    Attributes:
        kind: of the primitive.
        id: in the first library.
        scalar: which of its numbers.
        error: of the first library.
        reference: of the other.
    """

    kind: Literal["trim", "maneuver"]
    id: int
    scalar: str
    error: float
    reference: float

    @property
    def ratio(self) -> float | None:
        """Error over reference; None where the reference has none."""
        return self.error / self.reference if self.reference else None

    @property
    def same_order(self) -> bool:
        """Whether the ratio is between a quarter and four."""
        return self.ratio is not None and SAME_ORDER[0] <= self.ratio <= SAME_ORDER[1]


def error_ratios(library: Library, reference: Library) -> tuple[ErrorRatio, ...]:
    """Returns a ratio for each error of each primitive that both libraries have.

    Trims correspond where their velocities do, maneuvers where they join corresponding trims.
    """
    return tuple(_ratios(library, reference))


def _ratios(library: Library, reference: Library) -> Iterator[ErrorRatio]:
    twin: dict[int, int] = {}
    for trim in library.trims:
        for other in reference.trims:
            apart = trim_box(trim).centre - trim_box(other).centre
            if abs(apart).max() < _SAME_VELOCITY:
                twin[trim.id] = other.id
                sizes = zip(TRIM_SCALARS, trim_box(trim).size, trim_box(other).size, strict=True)
                for name, size, beside in sizes:
                    yield ErrorRatio("trim", trim.id, name, float(size), float(beside))
                break
    edges = {(row.from_trim, row.to_trim): row for row in reference.maneuvers}
    for row in library.maneuvers:
        printed = edges.get((twin.get(row.from_trim, -1), twin.get(row.to_trim, -1)))
        if printed is not None:
            sizes = zip(MANEUVER_SCALARS, maneuver_box(row).size, maneuver_box(printed).size, strict=True)
            for name, size, beside in sizes:
                yield ErrorRatio("maneuver", row.id, name, float(size), float(beside))
