"""`maneuver review`: a flight log as a summary and pictures."""

import json as json_module
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter
from rich.console import Console, Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from flight.arrival import Arrival
from flight.log import FlightLog, PrimitiveKind
from flight.log_file import read_log
from review.bounds import Bounds
from review.pictures import Limits, write_pictures
from review.summary import PrimitiveCount, Summary, summarise
from sim.parameters import model_hash, read_parameters

from .films import make_film, make_still

# Departures from bounds that are listed; the rest is counted.
MOST_DEPARTURES = 8


def review(
    log: Path,
    /,
    *,
    out: Path | None = None,
    video: Path | None = None,
    still: Path | None = None,
    at: float = 0.0,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Shows what was flown, commanded, believed and true in a flight log: a summary, and pictures to look at.

    For example:

        maneuver review flight.mcap

        maneuver review flight.mcap --out pictures --json

        maneuver review flight.mcap --video chase.mp4

        maneuver review flight.mcap --still chase.png --at 9

    Args:
        log: flight log.
        out: folder for the pictures; LOG's name with -review by default.
        video: also film the flight, as seen from a camera that follows, to FILE.mp4.
        still: also draw one picture of that film, to FILE.png.
        at: seconds into the flight of that picture.
        force: overwrite pictures and films of the same name.
        json: print the summary as JSON.
    """
    flight = read_log(log)
    summary = summarise(flight)
    folder = out or Path(f"{log.stem}-review")
    pictures = write_pictures(flight, folder, limits=control_limits(flight), force=force)
    if video is not None:
        make_film(flight, video, force=force)
    if still is not None:
        make_still(flight, still, time=at, force=force)
    if json:
        print(json_module.dumps({**summary_content(summary), "pictures": [str(path) for path in pictures]}))
        return 0
    Console(highlight=False).print(report(summary))
    others = ", ".join(path.name for path in pictures[1:])
    print(f"\nLook at {pictures[0]} first; beside it: {others}")
    return 0


def control_limits(log: FlightLog) -> Limits:
    """Returns the limits of the controls in radians, where the log was flown by the model that is shipped."""
    if log.header.model_hash != model_hash():
        return {}
    servos = read_parameters().servos
    cyclic = (-servos.cyclic_limit, servos.cyclic_limit)
    return {
        "collective": (servos.collective_low, servos.collective_high),
        "longitudinal": cyclic,
        "lateral": cyclic,
        "pedal": (servos.pedal_low, servos.pedal_high),
    }


def summary_content(summary: Summary) -> dict[str, Any]:
    """Returns the summary as plain JSON values; what the log does not hold is null."""
    content = asdict(summary)
    if summary.bounds is not None:
        for departure in content["bounds"]["departures"]:
            departure["kind"] = PrimitiveKind(departure["kind"]).name.lower()
    return content


def report(summary: Summary) -> Group:
    """Returns the summary for people."""
    parts: list[Table | Padding | Text] = [_facts(summary)]
    parts.append(_heading("Flown"))
    parts.append(_primitives(summary))
    if summary.tracking is not None:
        parts += [_heading("Truth minus command"), _tracking(summary)]
    if summary.bounds is not None and summary.bounds.departures:
        parts += [
            _heading(f"Furthest out of the bounds of library {summary.bounds.library}"),
            _departures(summary.bounds),
        ]
    return Group(*parts)


def _heading(text: str) -> Padding:
    return Padding(Text(text, style="bold"), (1, 0, 0, 0))


def _facts(summary: Summary) -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold")
    table.add_column()
    table.add_row(summary.kind, summary.name)
    table.add_row("vehicle", f"{summary.vehicle}, wind class {summary.wind}, seed {summary.seed}")
    table.add_row("flight", f"{summary.duration:.2f} s, {summary.distance:.1f} m over the ground")
    table.add_row("outcome", summary.outcome)
    if summary.arrival is not None:
        table.add_row("goal", _arrival(summary.arrival))
    if summary.plans is not None:
        table.add_row("plans found", str(summary.plans))
    table.add_row("time-outs", str(summary.timeouts))
    if summary.bounds is not None:
        table.add_row("out of bounds", _bounds(summary.bounds))
    if summary.navigation is not None:
        error = summary.navigation
        table.add_row(
            "navigation",
            f"position {error.position_rms:.2f} m rms, {error.position_max:.2f} m at most; "
            f"velocity {error.velocity_rms:.3f} m/s rms; heading {error.heading_rms:.4f} rad rms",
        )
    return table


def _arrival(arrival: Arrival) -> str:
    if arrival.time is None:
        return f"not reached; {arrival.closest:.2f} m at the closest"
    return f"reached after {arrival.time:.2f} s"


def _bounds(bounds: Bounds) -> str:
    coasts, maneuvers = bounds.left_by(PrimitiveKind.COAST), bounds.left_by(PrimitiveKind.MANEUVER)
    return (
        f"{coasts} of {bounds.coasts} coasts, {maneuvers} of {bounds.maneuvers} maneuvers "
        f"(library {bounds.library}, trim errors {bounds.trim_error_kind})"
    )


def _primitives(summary: Summary) -> Table:
    table = _columns("", "id", "", "times", "seconds", right=("id", "times", "seconds"))
    for kind, counts in (("trim", summary.trims), ("maneuver", summary.maneuvers)):
        for count in counts:
            table.add_row(kind, *_cells(count))
    return table


def _cells(count: PrimitiveCount) -> tuple[str, ...]:
    return str(count.id), count.name, str(count.count), f"{count.seconds:.2f}"


def _tracking(summary: Summary) -> Table:
    table = _columns("", "worst", "at", "rms", "", right=("worst", "at", "rms"))
    for error in summary.tracking or ():
        name = error.field.replace("_", " ")
        table.add_row(name, f"{error.worst:+.3f}", f"{error.time:.2f} s", f"{error.rms:.3f}", error.unit)
    return table


def _departures(bounds: Bounds) -> Table:
    table = _columns(
        "", "id", "from", "number", "deviation", "bound", right=("id", "from", "deviation", "bound")
    )
    furthest = sorted(bounds.departures, key=lambda d: -abs(d.deviation) / max(d.bound, 1e-9))
    for departure in furthest[:MOST_DEPARTURES]:
        table.add_row(
            departure.kind.name.lower(),
            str(departure.id),
            f"{departure.start:.2f} s",
            departure.number.replace("_", " "),
            f"{departure.deviation:+.3f}",
            f"{departure.bound:.3f}",
        )
    if len(furthest) > MOST_DEPARTURES:
        table.add_row(f"and {len(furthest) - MOST_DEPARTURES} more")
    return table


def _columns(*names: str, right: tuple[str, ...]) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for name in names:
        table.add_column(name, justify="right" if name in right else "left")
    return table
