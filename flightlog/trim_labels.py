"""Names and colours of trims in pictures, pages and viewers."""

from collections.abc import Iterable

from .attachment_names import LIBRARY_ATTACHMENT
from .log import FlightLog
from .primitives import PrimitiveKind, merged_primitives

# Okabe and Ito's palette without yellow, which is invisible on white; then Tol's muted palette.
_TRIMS = (
    *("#555555", "#56B4E9", "#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7"),
    *("#332288", "#117733", "#882255", "#AA4499", "#44AA99", "#999933", "#88CCEE"),
)


def trim_colors(trims: Iterable[int]) -> dict[int, str]:
    """Returns a colour #rrggbb for each trim, by order of ids."""
    return {trim: _TRIMS[place % len(_TRIMS)] for place, trim in enumerate(sorted(set(trims)))}


def trim_palette(log: FlightLog) -> dict[int, str]:
    """Returns a colour for each trim of library and flight.

    Raises:
        MissingTopicError: the log lacks primitives.
    """
    flown = {part.id for part in merged_primitives(log) if part.kind is PrimitiveKind.COAST}
    return trim_colors(flown | set(trim_names(log)))


def trim_names(log: FlightLog) -> dict[int, str]:
    """Returns trim names by id; empty without an attached library."""
    if LIBRARY_ATTACHMENT not in log.attachments:
        return {}
    return {trim.id: trim.name for trim in log.library().trims}


def trim_label(trim: int, names: dict[int, str]) -> str:
    """Returns a trim's id and, where known, its name."""
    return f"{trim} {names[trim]}" if trim in names else f"trim {trim}"
