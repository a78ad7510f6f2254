"""A library's data sheet: what it holds and what may be claimed from it, as Markdown for people."""

from collections.abc import Iterable, Sequence

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.maneuver_end import Band
from flight.automaton.statistics import InterpolationClaim, Statistics
from flight.automaton.trim import Trim


def data_sheet(library: Library) -> str:
    """Returns the data sheet of a library, in SI units."""
    conditions = library.conditions
    parts = [f"# {library.name}", library.description, _table(("what", "value"), _fact_rows(library))]
    parts += ["## Trims", _table(_TRIM_HEAD, map(_trim_row, library.trims))]
    if conditions.maneuver_end is not None:
        bands = sorted(conditions.maneuver_end.bands.items())
        parts += ["Bands around the trims:", _table(_BAND_HEAD, (_band_row(*band) for band in bands))]
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
        parts += ["## What is claimed", _CLAIM, *_outlier_section(library)]
    parts += _interpolated_section(library)
    return "\n\n".join(parts) + "\n"


def describe_sample_size(library: Library) -> str:
    """Returns in one sentence on how many flights a library rests, and what that is worth."""
    known = [trim.statistics for trim in library.trims] + [row.statistics for row in library.maneuvers]
    entries = [entry for entry in known if entry is not None]
    if not entries:
        return "its errors rest on no flights that it tells of"
    least, flights = min(entry.coverage for entry in entries), min(entry.samples for entry in entries)
    grown = len({row.id for row in library.maneuvers if row.interpolated})
    beside = f"; {grown} of its maneuvers are grown, never flown" if grown else ""
    return (
        f"its errors rest on {flights} flights and cover at least {100 * least:.0f} % of future ones, "
        f"primitive by primitive, with {100 * entries[0].confidence:.0f} % confidence{beside}"
    )


def describe_claim(claim: InterpolationClaim) -> str:
    """Returns for people what is claimed of interpolated primitives, and from what."""
    return (
        f"at least {100 * claim.coverage:.1f} % of them hold {claim.flights} flights each, all numbers at "
        f"once, with {100 * claim.confidence:.0f} % confidence (factor {claim.factor:.2f}; of "
        f"{claim.left_out} flown ones, each left out in turn, {claim.exceeding} exceed it)"
    )


def _fact_rows(library: Library) -> list[tuple[str, str]]:
    conditions = library.conditions
    rule, coasts, altitude = conditions.maneuver_end, conditions.coasting_range, conditions.altitude
    unknown = "not stated"
    speeds, entries, flown = conditions.speed_range, conditions.entry_trims, conditions.vehicle_hash
    judged = library.provenance.get("deviations_of")
    return [
        ("vehicle", library.vehicle),
        ("wind class", conditions.wind),
        ("altitude", unknown if altitude is None else f"{altitude:g} m"),
        ("trim errors", conditions.trim_error_kind),
        ("deviations of", f"the {judged} motion" if judged else unknown),
        ("vehicle's parameters", unknown if flown is None else f"sha256 {flown[:12]}"),
        ("speeds flown", unknown if speeds is None else f"{speeds[0]:g} to {speeds[1]:g} m/s"),
        ("trims left by maneuvers", unknown if entries is None else ", ".join(map(str, entries))),
        ("coasts flown", unknown if coasts is None else f"{coasts[0]:.1f} to {coasts[1]:.1f} s"),
        ("a maneuver ends", unknown if rule is None else f"after {rule.dwell:g} s inside the band"),
        ("time-out", unknown if rule is None else f"{rule.timeout:g} s"),
    ]


_BAND_HEAD = ("trim", "forward m/s", "side m/s", "yaw rate rad/s")
_EVIDENCE = ("samples", "discarded", "time-outs", "centre", "coverage")
_TRIM_HEAD = ("trim", "name", "forward m/s", "side m/s", "yaw rate rad/s", *_EVIDENCE)
_MANEUVER_HEAD = (
    *("maneuver", "edge", "duration s", "forward m", "side m", "heading change rad"),
    *_EVIDENCE,
)
_BIN_HEAD = ("trim", "coast s", "forward m/s", "side m/s", "yaw rate rad/s", "samples", "coverage")
_CLAIM = (
    "A sample is a flight. `coverage` is the share of future flights, flown under the same conditions and by "
    "the same schedule, in which all numbers of the primitive stay inside value ± |error| together, with the "
    "confidence that the library's `statistics` name. `centre` is where the values come from that deviations "
    "are counted from; what comes from the same flights as the bounds takes twice the numbers, so it claims "
    "less. A `discarded` sample is one that the bounds do not hold. A flight in which a maneuver did not "
    "settle, or that was lost, lies outside its bounds: it is counted and listed, and the claim accounts for "
    "it. Durations and displacements end where the true motion has settled; in flight the same rule is "
    "applied to the estimate. Errors are signed by the convention of `flight/automaton/sign_convention.py`."
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
        statistics.centre or "not told",
        f"{statistics.coverage:.3f}",
    )


def _averaged_section(library: Library) -> list[str]:
    """Returns the errors by coast duration, and what is to be known of them."""
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
    said = (
        "Errors of the velocity averaged over a coast, by its duration. Only flights with a coast that long "
        f"are samples: the weakest claim, {least.coverage:.3f}, is that of coasts of {least.shortest:.1f} to "
        f"{least.longest:.1f} s. No bin reaches below the shortest coast flown."
    )
    return ["## Errors by coast duration", said, table]


def _outlier_section(library: Library) -> list[str]:
    """Returns which flights lie outside the bounds, by seed, where there are some."""
    lost = library.provenance.get("lost") or []
    unsettled = library.provenance.get("unsettled") or {}
    lines = [f"- lost: seeds {', '.join(map(str, lost))}"] if lost else []
    lines += [
        f"- maneuver {number} did not settle: seeds {', '.join(map(str, seeds))}"
        for number, seeds in unsettled.items()
    ]
    return ["Flights outside the bounds:\n\n" + "\n".join(lines)] if lines else []


def _interpolated_section(library: Library) -> list[str]:
    """Returns what is claimed of primitives that were never flown, where there are some."""
    trims = [trim.id for trim in library.trims if trim.interpolated]
    rows = [row.id for row in library.maneuvers if row.interpolated]
    lines = [
        f"- {count} {words}: {describe_claim(claim)}"
        for count, words, claim in (
            (len(trims), "trims that are grown, or entered by grown maneuvers", _first_claim(library.trims)),
            (len(rows), "grown maneuvers", _first_claim(library.maneuvers)),
        )
        if claim is not None
    ]
    return ["## What is grown", "\n".join(lines)] if lines else []


def _first_claim(parts: Sequence[Trim] | Sequence[Maneuver]) -> InterpolationClaim | None:
    return next((part.interpolated for part in parts if part.interpolated), None)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
