"""`maneuver import`: flight log from another program's log."""

import json as json_module
import sys
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from flight.errors import FlightError
from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.file.writer import write_log
from flightlog.imports.kinds import importable, kind_of
from flightlog.log import FlightLog
from flightlog.topics import ESTIMATE, FAULT, FAULT_EFFECT, MOTION, TOPICS
from maneuver.options.import_options import ImportOptions, read_flight
from runtime.atomic_write import check_output_files

WITH_LOSS = 3
"""Exit code of an import that lacks part of the log."""

_BAD_INPUT, _MOST_BREAKS = 2, 10
_NO_OPTIONS = ImportOptions()


def import_log(
    logs: Annotated[list[Path], Parameter(negative="")],
    /,
    *,
    options: ImportOptions = _NO_OPTIONS,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Imports logs of PX4 and ArduPilot, MCAP files, ROS bags and tables.

    What the file does not hold is absent, not zero; review and identification use what is there. Where the
    file leaves a choice open or its numbers contradict what is assumed, one line names the option to give and
    the exit code is 2. Where more than 1 % of a file is left out the exit code is 3.

    FLIGHT.ulg: the estimate, the truth where a simulator logged it, the velocities asked for, controls and
    wind. Of a damaged one what is whole is imported.

    FLIGHT.bin: a DataFlash log of ArduPilot: the estimate, the velocities asked for, controls and wind.

    FLIGHT.mcap, FLIGHT.mcap.zstd, FLIGHT.bag, FLIGHT.db3 or the folder of a ROS 2 bag: --pose and --velocity
    name topics of ROS, protobuf or JSON messages such as Odometry, PoseStamped, TransformStamped, TFMessage,
    TwistStamped, NavSatFix, PoseInFrame. Axes are those of ROS unless stated: east, north, up and forward,
    left, up; of px4_msgs north, east, down and forward, right, down. A velocity is along the axes that its
    message states, or along the body in odometry and where its frame is not the pose's, otherwise along the
    world. Without one, the slope of the position is taken.

    FLIGHT.csv: --columns NAME=HEADING ..., NAME one of time, x y z, vx vy vz, qw qx qy qz, roll pitch yaw,
    wx wy wz, u1 to u12, lat lon alt, id; a heading that is such a name needs no mention; z, vz, roll
    and pitch may lack. Axes are north, east, down and forward, right, down unless stated; velocities are
    along the world's.

    Several logs, or a folder of them, become one log each.

    For example:

        maneuver import flight.ulg

        maneuver import bag.mcap --pose /odom

        maneuver import bag.mcap --pose /robot/pose --velocity /robot/twist --world enu --body flu

        maneuver import flight.csv --columns time=timestamp qw=q0 qx=q1 qy=q2 qz=q3 --time-unit us

        maneuver import logs --out flights

    Args:
        logs: FLIGHT.ulg, FLIGHT.bin, FLIGHT.mcap, FLIGHT.bag, FLIGHT.csv, or a folder.
        options: what a log does not say itself.
        out: flight log to write; LOG's name with .mcap by default. Of several logs, the folder for them.
        force: overwrite OUT.
        json: print the result as JSON.
    """
    paths = [each for log in logs for each in _found(log)]
    if len(paths) == 1 and not (logs[0].is_dir() and paths[0] != logs[0]):
        target = out or Path(f"{_stem(paths[0])}.mcap")
        return _import_one(paths[0], target, options, force=force, json=json)
    return _import_several(paths, out or Path(), options, force=force, json=json)


def _found(log: Path) -> list[Path]:
    """Returns the logs in a folder, or the log itself."""
    if not log.is_dir():
        return [log]
    inside = importable(log)
    try:
        kind_of(log)
    except FlightError:
        if inside:
            return inside
        raise
    return [log]


def _stem(path: Path) -> str:
    """Returns the name of a log without the endings of its kind."""
    return path.name if path.is_dir() else path.name.removesuffix(path.suffix).removesuffix(".mcap")


def _import_one(log: Path, path: Path, options: ImportOptions, *, force: bool, json: bool) -> int:
    check_output_files(path, force=force, inputs=[log])
    flight = read_flight(log, options)
    write_log(flight, path, force=force)
    facts = _facts(flight, path)
    if json:
        print(json_module.dumps(facts))
    else:
        _print_rows(flight, facts)
    return _warn(log, flight)


def _import_several(
    paths: list[Path], folder: Path, options: ImportOptions, *, force: bool, json: bool
) -> int:
    """Imports one log each, and prints a table of them."""
    names = [_stem(path) for path in paths]
    doubled = {name for name in names if names.count(name) > 1}
    targets = [
        folder / (f"{path.name}.mcap" if name in doubled else f"{name}.mcap")
        for path, name in zip(paths, names, strict=True)
    ]
    for path, target in zip(paths, targets, strict=True):
        check_output_files(target, force=force, inputs=[path])
    folder.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    for path, target in zip(paths, targets, strict=True):
        try:
            flight = read_flight(path, options)
        except FlightError as error:
            print(f"maneuver: {error}", file=sys.stderr)
            rows.append({"log": str(path), "exit": _BAD_INPUT, "reason": str(error)})
            continue
        write_log(flight, target, force=force)
        rows.append({**_facts(flight, target), "exit": _warn(path, flight)})
    if json:
        print(json_module.dumps(rows))
    else:
        width = max(len(str(row["log"])) for row in rows)
        for row in rows:
            held = f"{row['duration']:9.2f} s  {', '.join(row['held'])}" if "held" in row else "not imported"
            print(f"{row['log']:<{width}} {held}")
    return _worst(rows)


def _worst(rows: list[dict[str, Any]]) -> int:
    """Returns 2 for a refused log, 3 for one with loss."""
    codes = {int(row["exit"]) for row in rows}
    return _BAD_INPUT if _BAD_INPUT in codes else max(codes)


def _facts(flight: FlightLog, path: Path) -> dict[str, Any]:
    contract = [topic for topic in TOPICS if topic not in (MOTION, FAULT, FAULT_EFFECT)]
    held = {
        topic.name: list(flight[topic].topic.field_names) for topic in contract if topic.name in flight.series
    }
    return {
        "log": str(path),
        "duration": flight.duration,
        "held": held,
        "absent": [topic.name for topic in contract if topic.name not in flight.series],
        "absent_of_the_state": [name for name in ESTIMATE.field_names if not flight.motion.has_fields(name)],
        "import": json_module.loads(flight.attachments[IMPORT_ATTACHMENT]),
    }


def _print_rows(flight: FlightLog, facts: dict[str, Any]) -> None:
    rows = [
        ("log", facts["log"]),
        ("duration", f"{facts['duration']:.2f} s"),
        ("topics", ", ".join(facts["held"])),
    ]
    if facts["absent_of_the_state"]:
        rows.append(
            ("missing fields", f"{', '.join(facts['absent_of_the_state'])} of {flight.motion.topic.name}")
        )
    rows.append(("missing topics", ", ".join(facts["absent"])))
    taken: dict[str, Any] = facts["import"]
    rows += [(name, value) for name, value in taken.items() if isinstance(value, str) and name != "sha256"]
    rows += [("left out", sentence) for sentence in taken.get("left out", [])]
    rows += [
        ("break", f"{each['time']:.2f} s: {each['reason']}")
        for each in taken.get("breaks", [])[:_MOST_BREAKS]
    ]
    more = len(taken.get("breaks", [])) - _MOST_BREAKS
    if more > 0:
        rows.append(("break", f"and {more} more"))
    width = max(len(name) for name, _ in rows)
    for name, value in rows:
        print(f"{name:<{width}} {value}")


def _warn(log: Path, flight: FlightLog) -> int:
    """Says on stderr what is lacking; returns the exit code."""
    if flight.header.outcome == "completed":
        return 0
    print(f"maneuver: {log}: {flight.header.outcome}", file=sys.stderr)
    return WITH_LOSS
