"""Sections of a data sheet on joint laws: trims, maneuvers, dependence."""

from collections.abc import Callable, Iterable, Sequence
from math import sqrt

from flight.automaton.joint_law import ManeuverLaw, TrimLaw
from flight.automaton.library import Library
from identification.statistics.dependence import LARGEST_CORRELATION

Table = Callable[[Sequence[str], Iterable[Sequence[str]]], str]

COASTS = (1.0, 2.0, 4.0, 8.0)
"""Seconds, in the table of growing errors."""

_TRIM_HEAD = ("trim", "mean m/s, m/s, rad/s", "between flights", "within a coast", "correlation time s")
_GROWTH_HEAD = ("trim", *(f"after {coast:g} s" for coast in COASTS), "coverage")
_MANEUVER_HEAD = ("maneuver", "duration s", "forward m", "side m", "heading change rad")
_ENTRY_HEAD = (*_MANEUVER_HEAD, "coverage")
_TRIM_TEXT = (
    "Mean velocity of each trim beside its command, and standard deviations of its forward and side velocity "
    "and yaw rate: of a flight's mean, and of the fluctuation within a coast (a first-order Gauss-Markov "
    "process with the correlation time). Exact policies keep the commands and the constant errors."
)
_GROWTH_TEXT = (
    "Bounds of the errors after a coast: metres forward and to the side, radians. They hold at all times of "
    "all coasts of a flight at once, in the share of flights that is `coverage`."
)
_MANEUVER_TEXT = (
    "Mean ± standard deviation over all flights and entries. The library's file has the covariance, joint "
    "deviations of up to 64 flights (row k of every primitive is of the same flight), and the mean path with "
    "its spread at nine instants. Exact policies keep the constant values and errors above."
)


def law_sections(library: Library, table: Table) -> list[str]:
    """Returns the sections on joint laws; none without laws.

    Args:
        library: the library.
        table: function that lays out a table.
    """
    held = [(trim.id, trim.law) for trim in library.trims if trim.law is not None]
    flown = [(row.id, row.law) for row in library.maneuvers if row.law is not None]
    parts = []
    if held:
        parts += ["## Laws of trims", _TRIM_TEXT, table(_TRIM_HEAD, (_trim_row(*one) for one in held))]
        grown = [(number, law) for number, law in held if law.bounds is not None and law.coverage]
        if grown:
            parts += [_GROWTH_TEXT, table(_GROWTH_HEAD, (_growth_row(*one) for one in grown))]
    if flown:
        rows = (_maneuver_row(*one) for one in flown)
        parts += ["## Laws of maneuvers", _MANEUVER_TEXT, table(_MANEUVER_HEAD, rows)]
        entered = [(number, law) for number, law in flown if law.claims_entries]
        if entered:
            parts += [_entry_text(entered), table(_ENTRY_HEAD, (_entry_row(*one) for one in entered))]
    return [*parts, *_dependence(library)]


def _trim_row(number: int, law: TrimLaw) -> Sequence[str]:
    mean = law.mean
    return (
        str(number),
        f"{mean.forward:.3f}, {mean.side:+.3f}, {mean.yaw_rate:+.4f}",
        _velocities([sqrt(law.covariance[place][place]) for place in range(3)]),
        _velocities(law.within.standard_deviation),
        ", ".join(f"{time:.2f}" for time in law.within.correlation_time),
    )


def _velocities(values: Sequence[float]) -> str:
    forward, side, yaw_rate = values
    return f"{forward:.3f}, {side:.3f}, {yaw_rate:.4f}"


def _growth_row(number: int, law: TrimLaw) -> Sequence[str]:
    cells = [_lengths(law.bounds_after(coast) or ()) for coast in COASTS]
    return str(number), *cells, f"{law.coverage:.3f}"


def _lengths(values: Sequence[float]) -> str:
    forward, side, heading = values
    return f"{forward:.2f}, {side:.2f}, {heading:.3f}"


def _maneuver_row(number: int, law: ManeuverLaw) -> Sequence[str]:
    spread = [sqrt(law.covariance[place][place]) for place in range(4)]
    cells = [f"{mean:.2f} ± {one:.2f}" for mean, one in zip(law.mean[:3], spread[:3], strict=True)]
    return str(number), *cells, f"{law.mean[3]:.3f} ± {spread[3]:.3f}"


def _entry_text(entered: Sequence[tuple[int, ManeuverLaw]]) -> str:
    (fade,) = {law.entry.fade_time for _, law in entered if law.entry is not None}
    return (
        "Bounds of deviations from the mean for an entry, which depends on the maneuver before (its shift "
        f"fades with the coast as exp(-t / {fade:g} s)) and on the entry velocity that the vehicle believes. "
        "Terms, fade time and shrinkage are the simplest that held-out flights prefer."
    )


def _entry_row(number: int, law: ManeuverLaw) -> Sequence[str]:
    assert law.entry is not None
    assert law.entry.bounds is not None
    duration, forward, side, heading = law.entry.bounds
    cells = (f"{duration:.2f}", f"{forward:.2f}", f"{side:.2f}", f"{heading:.3f}")
    return str(number), *cells, f"{law.entry.coverage:.3f}"


def _dependence(library: Library) -> list[str]:
    """Returns the paragraph on what flights and successive maneuvers share."""
    shares = library.provenance.get("variance_between_flights")
    successive = library.provenance.get("correlation_of_successive")
    if not shares or not successive:
        return []
    listed = ", ".join(f"{name.replace('_', ' ')} {100 * share:.0f} %" for name, share in shares.items())
    largest, names = successive["largest"], [name.replace("_", " ") for name in successive["of"]]
    verdict = "independent" if largest <= LARGEST_CORRELATION else "NOT independent"
    return [
        f"Share of variance between flights: {listed}. Beyond that, successive maneuvers count as {verdict}: "
        f"the largest correlation of their values is {largest:.2f}, of {names[0]} and {names[1]} (limit "
        f"{LARGEST_CORRELATION:g})."
    ]
