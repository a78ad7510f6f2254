"""A library's data sheet: what it holds and what may be claimed from it, as Markdown for people."""

from collections.abc import Iterable, Sequence

from flight.library import Library
from flight.maneuver import Maneuver
from flight.maneuver_end import Band
from flight.statistics import Statistics
from flight.trim import Trim


def data_sheet(library: Library) -> str:
    """Returns the data sheet of a library, in SI units."""
    conditions = library.conditions
    parts = [f"# {library.name}", library.description, _table(("what", "value"), _facts(library))]
    parts += ["## Trims", _table(_TRIM_HEAD, map(_trim_row, library.trims))]
    if conditions.maneuver_end is not None:
        bands = sorted(conditions.maneuver_end.bands.items())
        parts += ["Bands around the trims:", _table(_BAND_HEAD, (_band_row(*band) for band in bands))]
    parts += ["## Maneuvers", _table(_MANEUVER_HEAD, map(_maneuver_row, library.maneuvers))]
    notes = [f"- maneuver {row.id}: {row.notes}" for row in library.maneuvers if row.notes]
    if notes:
        parts += ["## Notes", "\n".join(notes)]
    if any(trim.statistics for trim in library.trims):
        parts += ["## What is claimed", _CLAIM]
    return "\n\n".join(parts) + "\n"


def worth(library: Library) -> str:
    """Returns in one sentence on how many flights a library rests, and what that is worth."""
    known = [trim.statistics for trim in library.trims] + [row.statistics for row in library.maneuvers]
    entries = [entry for entry in known if entry is not None]
    if not entries:
        return "its errors rest on no flights that it tells of"
    least, flights = min(entry.coverage for entry in entries), min(entry.samples for entry in entries)
    return (
        f"its errors rest on {flights} flights and cover at least {100 * least:.0f} % of future ones, "
        f"primitive by primitive, with {100 * entries[0].confidence:.0f} % confidence"
    )


def _facts(library: Library) -> list[tuple[str, str]]:
    conditions = library.conditions
    rule, coasts, altitude = conditions.maneuver_end, conditions.coasting_range, conditions.altitude
    unknown = "not stated"
    return [
        ("vehicle", library.vehicle),
        ("wind class", conditions.wind),
        ("altitude", unknown if altitude is None else f"{altitude:g} m"),
        ("trim errors", conditions.trim_error_kind),
        ("coasts flown", unknown if coasts is None else f"{coasts[0]:.1f} to {coasts[1]:.1f} s"),
        ("a maneuver ends", unknown if rule is None else f"after {rule.dwell:g} s inside the band"),
        ("time-out", unknown if rule is None else f"{rule.timeout:g} s"),
    ]


_BAND_HEAD = ("trim", "forward m/s", "side m/s", "yaw rate rad/s")
_TRIM_HEAD = ("trim", "name", "forward m/s", "side m/s", "yaw rate rad/s", "samples", "coverage")
_MANEUVER_HEAD = (
    *("maneuver", "edge", "duration s", "forward m", "side m", "heading change rad"),
    *("samples", "time-outs", "coverage"),
)
_CLAIM = (
    "A sample is a flight. `coverage` is the share of future flights, flown under the same conditions and by "
    "the same schedule, in which all numbers of the primitive stay inside value ± |error| together, with the "
    "confidence that the library's `statistics` name. A flight in which a maneuver did not settle, or that "
    "was lost, lies outside its bounds: it is counted and listed, and the claim accounts for it. Durations "
    "and displacements end where the true motion has settled; in flight the same rule is applied to the "
    "estimate. Errors are signed by the convention of `flight/sign_convention.py`."
)


def _band_row(trim: int, band: Band) -> Sequence[str]:
    return str(trim), f"{band.forward:.3f}", f"{band.side:.3f}", f"{band.yaw_rate:.4f}"


def _trim_row(trim: Trim) -> Sequence[str]:
    velocity, error = trim.velocity, trim.error
    return (
        str(trim.id),
        trim.name,
        f"{velocity.forward:.3f} {error.forward:+.3f}",
        f"{velocity.side:.3f} {error.side:+.3f}",
        f"{velocity.yaw_rate:.4f} {error.yaw_rate:+.4f}",
        *_claim(trim.statistics),
    )


def _maneuver_row(maneuver: Maneuver) -> Sequence[str]:
    displacement, error = maneuver.displacement, maneuver.error
    samples, coverage = _claim(maneuver.statistics)
    return (
        str(maneuver.id),
        f"{maneuver.from_trim} → {maneuver.to_trim}",
        f"{maneuver.duration:.2f} {error.duration:+.2f}",
        f"{displacement.x:.2f} {error.forward:+.2f}",
        f"{displacement.y:.2f} {error.side:+.2f}",
        f"{displacement.heading:.3f} {error.heading_change:+.3f}",
        samples,
        str(maneuver.statistics.timeouts) if maneuver.statistics else "-",
        coverage,
    )


def _claim(statistics: Statistics | None) -> tuple[str, str]:
    if statistics is None:
        return "-", "-"
    return str(statistics.samples), f"{statistics.coverage:.3f}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
