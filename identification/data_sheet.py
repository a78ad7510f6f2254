"""Data sheet of a library in Markdown: values, errors, coverage claims."""

from collections.abc import Iterable, Sequence

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.maneuver_end import Band
from flight.automaton.statistics import InterpolationClaim, Statistics
from flight.automaton.trim import Trim
from flight.plural import plural


def data_sheet(library: Library) -> str:
    """Returns the data sheet of a library, in SI units."""
    conditions = library.conditions
    parts = [f"# {library.name}", library.description, _table(("property", "value"), _fact_rows(library))]
    parts += ["## Trims", _table(_TRIM_HEAD, map(_trim_row, library.trims))]
    if conditions.maneuver_end is not None:
        bands = sorted(conditions.maneuver_end.bands.items())
        parts += [
            "Half widths of the bands around the trims:",
            _table(_BAND_HEAD, (_band_row(*band) for band in bands)),
        ]
    parts += _averaged_section(library)
    parts += ["## Maneuvers", _table(_MANEUVER_HEAD, map(_maneuver_row, library.maneuvers))]
    notes = [
        f"- maneuver {row.id}: {row.notes}"
        for row in library.maneuvers
        if row.notes and row.interpolated is None
    ]
    if notes:
        parts += ["## Notes", "\n".join(notes)]
    if any(trim.statistics for trim in library.trims):
        claim = _CLAIM.format(future_flights=conditions.future_flights)
        parts += ["## Coverage claims", claim, *_outlier_section(library)]
    parts += _interpolated_section(library)
    return "\n\n".join(parts) + "\n"


def describe_sample_size(library: Library) -> str:
    """Returns the number of flights and the coverage in one sentence."""
    known = [trim.statistics for trim in library.trims] + [row.statistics for row in library.maneuvers]
    entries = [entry for entry in known if entry is not None]
    if not entries:
        return "errors without statistics: the library states no flights"
    least, flights = min(entry.coverage for entry in entries), min(entry.samples for entry in entries)
    interpolated = len({row.id for row in library.maneuvers if row.interpolated})
    beside = f"; {plural(interpolated, 'maneuver')} interpolated, never flown" if interpolated else ""
    return (
        f"errors from {flights} flights; each primitive's bounds cover at least {100 * least:.0f} % of "
        f"{library.conditions.future_flights} ({100 * entries[0].confidence:.0f} % confidence){beside}"
    )


def describe_claim(claim: InterpolationClaim) -> str:
    """Returns the coverage claim of interpolated primitives in one sentence."""
    return (
        f"for at least {100 * claim.coverage:.1f} % of them, the bounds hold all numbers of "
        f"{claim.flights} flights each ({100 * claim.confidence:.0f} % confidence; errors scaled by "
        f"{claim.factor:.2f}; in cross-validation {claim.exceeding} of {claim.left_out} flown primitives "
        "exceed this factor)"
    )


def _fact_rows(library: Library) -> list[tuple[str, str]]:
    conditions = library.conditions
    rule, coasts, altitude = conditions.maneuver_end, conditions.coasting_range, conditions.altitude
    unknown = "not stated"
    speeds, entries, flown = conditions.speed_range, conditions.entry_trims, conditions.vehicle_hash
    motion = library.provenance.get("deviations_of")
    return [
        ("vehicle", library.vehicle),
        ("wind class", conditions.wind),
        ("air", conditions.air or unknown),
        ("altitude", unknown if altitude is None else f"{altitude:g} m"),
        ("trim errors", conditions.trim_error_kind),
        ("deviations of", f"the {_MOTIONS.get(motion, motion)} motion" if motion else unknown),
        ("vehicle parameters", unknown if flown is None else f"sha256 {flown[:12]}"),
        ("vehicles flown", conditions.vehicles or unknown),
        ("sensors", conditions.sensors or unknown),
        ("speeds flown", unknown if speeds is None else f"{speeds[0]:g} to {speeds[1]:g} m/s"),
        ("maneuvers flown from trims", unknown if entries is None else ", ".join(map(str, entries))),
        ("coasts flown", unknown if coasts is None else f"{coasts[0]:.1f} to {coasts[1]:.1f} s"),
        ("end of a maneuver", unknown if rule is None else f"after {rule.dwell:g} s inside the band"),
        ("time-out", unknown if rule is None else f"{rule.timeout:g} s"),
    ]


# Provenance has `believed` for the estimate.
_MOTIONS = {"believed": "estimated"}
_BAND_HEAD = ("trim", "forward m/s", "side m/s", "yaw rate rad/s")
_EVIDENCE = ("samples", "discarded", "time-outs", "centre", "coverage")
_TRIM_HEAD = ("trim", "name", "forward m/s", "side m/s", "yaw rate rad/s", *_EVIDENCE)
_MANEUVER_HEAD = (
    *("maneuver", "edge", "duration s", "forward m", "side m", "heading change rad"),
    *_EVIDENCE,
)
_BIN_HEAD = ("trim", "coast s", "forward m/s", "side m/s", "yaw rate rad/s", "samples", "coverage")
_CLAIM = (
    "A sample is a flight. `coverage` is the share of {future_flights}, under the same conditions and "
    "with the same schedule, in which all numbers of the primitive stay inside value ± |error| at once, at "
    "the confidence of the library's `statistics`. `centre` is the source of the values that deviations are "
    "measured from; values from the same flights as the bounds need twice as many fitted numbers, so their "
    "coverage is lower. A `discarded` sample is outside the bounds: a lost flight, or one in which the "
    "maneuver did not settle. It is counted and listed, and the coverage accounts for it. Durations and "
    "displacements end where the true motion has settled; in flight the same rule is applied to the "
    "estimate. Signs of errors: of trims as their nominal values; of maneuvers, duration negative, forward "
    "opposite to the motion, heading change with the turn, side against it (thesis, 3.2.6)."
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
        *_claim_cells(trim.statistics),
    )


def _maneuver_row(maneuver: Maneuver) -> Sequence[str]:
    displacement, error = maneuver.displacement, maneuver.error
    return (
        str(maneuver.id),
        f"{maneuver.from_trim} → {maneuver.to_trim}",
        f"{maneuver.duration:.2f} {error.duration:+.2f}",
        f"{displacement.x:.2f} {error.forward:+.2f}",
        f"{displacement.y:.2f} {error.side:+.2f}",
        f"{displacement.heading:.3f} {error.heading_change:+.3f}",
        *_claim_cells(maneuver.statistics),
    )


def _claim_cells(statistics: Statistics | None) -> tuple[str, str, str, str, str]:
    if statistics is None:
        return "-", "-", "-", "-", "-"
    return (
        str(statistics.samples),
        str(statistics.discarded),
        str(statistics.timeouts),
        statistics.centre or "not stated",
        f"{statistics.coverage:.3f}",
    )


def _averaged_section(library: Library) -> list[str]:
    """Returns the section on errors by coast duration."""
    rows = [(trim.id, part) for trim in library.trims for part in trim.averaged]
    if not rows:
        return []
    table = _table(
        _BIN_HEAD,
        (
            (
                str(number),
                f"{part.shortest:.2f} to {part.longest:.2f}",
                *(f"{error:+.3f}" for error in (part.error.forward, part.error.side)),
                *(f"{part.error.yaw_rate:+.4f}", str(part.samples), f"{part.coverage:.3f}"),
            )
            for number, part in rows
        ),
    )
    least = min((part for _, part in rows), key=lambda part: part.coverage)
    text = (
        "Errors of the velocity averaged over a coast, by its duration. Samples are flights with a coast of "
        f"that duration: the lowest coverage, {least.coverage:.3f}, is that of coasts of "
        f"{least.shortest:.1f} to {least.longest:.1f} s. No bin is below the shortest coast flown."
    )
    return ["## Errors by coast duration", text, table]


def _outlier_section(library: Library) -> list[str]:
    """Returns the section on flights outside the bounds, by seed."""
    lost = library.provenance.get("lost") or []
    unsettled = library.provenance.get("unsettled") or {}
    lines = [f"- lost: seeds {', '.join(map(str, lost))}"] if lost else []
    lines += [
        f"- maneuver {number} did not settle: seeds {', '.join(map(str, seeds))}"
        for number, seeds in unsettled.items()
    ]
    return ["Flights outside the bounds:\n\n" + "\n".join(lines)] if lines else []


def _interpolated_section(library: Library) -> list[str]:
    """Returns the section on interpolated primitives."""
    trims = [trim.id for trim in library.trims if trim.interpolated]
    rows = [row.id for row in library.maneuvers if row.interpolated]
    lines = [
        f"- {count} {words}: {describe_claim(claim)}"
        for count, words, claim in (
            (
                len(trims),
                "trims, interpolated or entered by interpolated maneuvers",
                _first_claim(library.trims),
            ),
            (len(rows), "interpolated maneuvers", _first_claim(library.maneuvers)),
        )
        if claim is not None
    ]
    return ["## Interpolated primitives", "\n".join(lines)] if lines else []


def _first_claim(parts: Sequence[Trim] | Sequence[Maneuver]) -> InterpolationClaim | None:
    return next((part.interpolated for part in parts if part.interpolated), None)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
