"""`maneuver import`: flight log from another program's log."""

import json as json_module
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from cyclopts import Parameter

from flight.errors import FlightError
from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.file.writer import write_log
from flightlog.imports.axes import Axes, BodyAxes, WorldAxes
from flightlog.imports.clock import TimeUnit
from flightlog.imports.csv_log import read_external_csv
from flightlog.imports.mcap_log import McapImportSettings, VelocityAxes, read_external_mcap
from flightlog.imports.measured_motion import velocity_disagreement
from flightlog.imports.px4_log import read_px4_log
from flightlog.log import FlightLog
from flightlog.topics import ESTIMATE, FAULT, FAULT_EFFECT, MOTION, TOPICS, TRUTH
from runtime.atomic_write import check_output_files

WITH_LOSS = 3
# Positions and velocities that belong together differ by less, as a share of the speed and in m/s.
MOST_DIFFERENT, LEAST_DIFFERENCE = 0.25, 0.1


def import_log(
    log: Path,
    /,
    *,
    pose: str | None = None,
    velocity: str | None = None,
    columns: Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")] = (),
    time_unit: TimeUnit | None = None,
    world: WorldAxes | None = None,
    body: BodyAxes | None = None,
    velocity_in: VelocityAxes | None = None,
    as_: Annotated[Literal["estimate", "truth"] | None, Parameter(name="--as")] = None,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Imports a PX4 ULog, an MCAP file or a table.

    Data that the file lacks are absent from the log, not zero. Review and identification use what is present.

    FLIGHT.ulg: estimate, truth if a simulator logged it, velocity setpoints, controls and wind. The intact
    part of a damaged file is imported, with exit code 3.

    FLIGHT.mcap: --pose and --velocity name topics with ROS 2, protobuf or JSON messages such as Odometry,
    PoseStamped, TransformStamped, TwistStamped, PoseInFrame. Default axes are those of ROS: world east,
    north, up and body forward, left, up; for px4_msgs north, east, down and forward, right, down. Velocities
    are in body axes in Odometry messages and if their frame differs from the pose's, otherwise in world
    axes. Without a velocity topic, velocity is the slope of the position.

    FLIGHT.csv: --columns NAME=HEADING ..., with NAME one of time, x y z, vx vy vz, qw qx qy qz, roll pitch
    yaw, wx wy wz, u1 to u12. Headings that equal a NAME need no option. z, vz, roll and pitch are optional.
    Default axes are north, east, down and forward, right, down; velocities are in world axes.

    For example:

        maneuver import flight.ulg

        maneuver import bag.mcap --pose /odom

        maneuver import bag.mcap --pose /robot/pose --velocity /robot/twist --world enu --body flu

        maneuver import flight.csv --columns time=timestamp qw=q0 qx=q1 qy=q2 qz=q3 --time-unit us

    Args:
        log: FLIGHT.ulg, FLIGHT.mcap or FLIGHT.csv.
        pose: topic of an MCAP file with position and attitude.
        velocity: topic of an MCAP file with the velocity; the pose topic by default.
        columns: columns of a table, as NAME=HEADING.
        time_unit: unit of a table's times; seconds by default, if plausible.
        world: world axes: north, east, down or east, north, up.
        body: body axes: forward, right, down or forward, left, up.
        velocity_in: axes of an MCAP file's velocities: world or body.
        as_: meaning of an MCAP file or table: the vehicle's estimate (the default), or the truth, such as
            from a motion-capture system.
        out: flight log to write; LOG's name with .mcap by default.
        force: overwrite OUT.
        json: print the result as JSON.
    """
    path = out or Path(f"{log.stem}.mcap")
    check_output_files(path, force=force, inputs=[log])
    stated = {"pose": pose, "velocity": velocity, "velocity_in": velocity_in}
    table = {"columns": columns, "time_unit": time_unit}
    topic = TRUTH if as_ == "truth" else ESTIMATE
    if log.suffix == ".ulg":
        _check_options("a .ulg file", {**stated, **table, "world": world, "body": body, "as": as_})
        flight = read_px4_log(log)
    elif log.suffix == ".mcap":
        _check_options("an .mcap file", table)
        if pose is None:
            raise FlightError(
                f"{log}: expected --pose TOPIC, and --velocity TOPIC if it is another, got none"
            )
        flight = read_external_mcap(
            log, McapImportSettings(pose, velocity, world, body, velocity_in), topic=topic
        )
    elif log.suffix == ".csv":
        _check_options("a .csv file", stated)
        axes = Axes(world or "ned", body or "frd")
        flight = read_external_csv(log, _pairs(columns), axes=axes, time_unit=time_unit, topic=topic)
    else:
        raise FlightError(f"expected FLIGHT.ulg, FLIGHT.mcap or FLIGHT.csv, got {log}")
    write_log(flight, path, force=force)
    _report(flight, path, json=json)
    return _warn(log, flight)


def _check_options(kind: str, options: Mapping[str, object]) -> None:
    """Refuses options that a kind of file does not have."""
    given = [f"--{name.replace('_', '-')}" for name, value in options.items() if value]
    if given:
        raise FlightError(f"{', '.join(given)}: not valid for {kind}")


def _pairs(columns: tuple[str, ...]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for words in columns:
        name, sign, heading = words.partition("=")
        if not (name and sign and heading):
            raise FlightError(f"--columns: expected NAME=HEADING, got {words!r}")
        if name in pairs:
            raise FlightError(f"--columns: {name} is given twice, as {pairs[name]!r} and {heading!r}")
        pairs[name] = heading
    return pairs


def _report(flight: FlightLog, path: Path, *, json: bool) -> None:
    contract = [topic for topic in TOPICS if topic not in (MOTION, FAULT, FAULT_EFFECT)]
    held = {
        topic.name: list(flight[topic].topic.field_names) for topic in contract if topic.name in flight.series
    }
    absent = [topic.name for topic in contract if topic.name not in flight.series]
    states = flight.motion
    missing = [name for name in ESTIMATE.field_names if not states.has_fields(name)]
    taken: dict[str, Any] = json_module.loads(flight.attachments[IMPORT_ATTACHMENT])
    if json:
        facts = {"log": str(path), "duration": flight.duration, "held": held, "absent": absent}
        print(json_module.dumps({**facts, "absent_of_the_state": missing, "import": taken}))
        return
    rows = [("log", str(path)), ("duration", f"{flight.duration:.2f} s"), ("topics", ", ".join(held))]
    if missing:
        rows.append(("missing fields", f"{', '.join(missing)} of {states.topic.name}"))
    rows.append(("missing topics", ", ".join(absent)))
    rows += [
        (name, str(value)) for name, value in taken.items() if isinstance(value, str) and name != "sha256"
    ]
    width = max(len(name) for name, _ in rows)
    for name, value in rows:
        print(f"{name:<{width}} {value}")


def _warn(log: Path, flight: FlightLog) -> int:
    """Prints warnings about an imported log on stderr; returns the exit code."""
    found = velocity_disagreement(flight.motion)
    if found is not None and found[0] > max(MOST_DIFFERENT * found[1], LEAST_DIFFERENCE):
        print(
            f"maneuver: {log}: velocities differ from the slope of the positions by {found[0]:.2f} m/s at a "
            f"speed of {found[1]:.2f} m/s: check --world, --body, --velocity-in, and --time-unit of tables",
            file=sys.stderr,
        )
    states = flight.motion
    if states.has_fields("roll", "pitch") and np.mean(np.cos(states["roll"]) * np.cos(states["pitch"])) < 0.0:
        print(f"maneuver: {log}: inverted flight most of the time: check --world and --body", file=sys.stderr)
    if flight.header.outcome != "completed":
        print(f"maneuver: {log}: {flight.header.outcome}", file=sys.stderr)
        return WITH_LOSS
    return 0
