"""`maneuver import`: a flight that another program logged, as a log of ours."""

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

    What the file does not hold is absent, not zero; review and identification use what is there.

    FLIGHT.ulg: the estimate, the truth where a simulator logged it, the velocities asked for, controls and
    wind. Of a damaged one what is whole is imported, and the exit code is 3.

    FLIGHT.mcap: --pose and --velocity name topics of ROS 2, protobuf or JSON messages such as Odometry,
    PoseStamped, TransformStamped, TwistStamped, PoseInFrame. Axes are those of ROS unless stated: east,
    north, up and forward, left, up; of px4_msgs north, east, down and forward, right, down. A velocity is
    along the body in odometry and where its frame is not the pose's, otherwise along the world. Without one,
    the slope of the position is taken.

    FLIGHT.csv: --columns NAME=HEADING ..., NAME one of time, x y z, vx vy vz, qw qx qy qz, roll pitch yaw,
    wx wy wz, u1 to u12; a heading that is such a name needs no mention; z, vz, roll and pitch may lack. Axes
    are north, east, down and forward, right, down unless stated; velocities are along the world's.

    For example:

        maneuver import flight.ulg

        maneuver import bag.mcap --pose /odom

        maneuver import bag.mcap --pose /robot/pose --velocity /robot/twist --world enu --body flu

        maneuver import flight.csv --columns time=timestamp qw=q0 qx=q1 qy=q2 qz=q3 --time-unit us

    Args:
        log: FLIGHT.ulg, FLIGHT.mcap or FLIGHT.csv.
        pose: topic of an MCAP that says where the vehicle is and how it stands.
        velocity: topic of an MCAP that says how it moves; the pose's own topic by default.
        columns: of a table, as NAME=HEADING.
        time_unit: of a table's times; seconds by default, where they can be.
        world: axes of the world: north, east, down or east, north, up.
        body: axes of the body: forward, right, down or forward, left, up.
        velocity_in: whether an MCAP's velocities are along the world's axes or the body's.
        as_: whether an MCAP or a table holds what the vehicle believed (the default) or what was so, as a
            camera system knows it.
        out: flight log to write; LOG's name with .mcap by default.
        force: overwrite OUT.
        json: print what came of it as JSON.
    """
    path = out or Path(f"{log.stem}.mcap")
    check_output_files(path, force=force, inputs=[log])
    stated = {"pose": pose, "velocity": velocity, "velocity_in": velocity_in}
    table = {"columns": columns, "time_unit": time_unit}
    topic = TRUTH if as_ == "truth" else ESTIMATE
    if log.suffix == ".ulg":
        _check_options(
            "a ULog says what it holds", {**stated, **table, "world": world, "body": body, "as": as_}
        )
        flight = read_px4_log(log)
    elif log.suffix == ".mcap":
        _check_options("they are for tables", table)
        if pose is None:
            raise FlightError(f"{log}: expected --pose TOPIC, and --velocity TOPIC where that is another one")
        flight = read_external_mcap(
            log, McapImportSettings(pose, velocity, world, body, velocity_in), topic=topic
        )
    elif log.suffix == ".csv":
        _check_options("they are for MCAP files", stated)
        axes = Axes(world or "ned", body or "frd")
        flight = read_external_csv(log, _pairs(columns), axes=axes, time_unit=time_unit, topic=topic)
    else:
        raise FlightError(f"expected FLIGHT.ulg, FLIGHT.mcap or FLIGHT.csv, got {log}")
    write_log(flight, path, force=force)
    _report(flight, path, json=json)
    return _warn(log, flight)


def _check_options(reason: str, options: Mapping[str, object]) -> None:
    """Refuses options that a file of this kind has no use for."""
    given = [f"--{name.replace('_', '-')}" for name, value in options.items() if value]
    if given:
        raise FlightError(f"{', '.join(given)} cannot be given here: {reason}")


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
    wanting = [name for name in ESTIMATE.field_names if not states.has_fields(name)]
    taken: dict[str, Any] = json_module.loads(flight.attachments[IMPORT_ATTACHMENT])
    if json:
        facts = {"log": str(path), "duration": flight.duration, "held": held, "absent": absent}
        print(json_module.dumps({**facts, "absent_of_the_state": wanting, "import": taken}))
        return
    rows = [("log", str(path)), ("duration", f"{flight.duration:.2f} s"), ("held", ", ".join(held))]
    if wanting:
        rows.append(("not held", f"{', '.join(wanting)} of {states.topic.name}"))
    rows.append(("absent", ", ".join(absent)))
    rows += [
        (name, str(value)) for name, value in taken.items() if isinstance(value, str) and name != "sha256"
    ]
    width = max(len(name) for name, _ in rows)
    for name, value in rows:
        print(f"{name:<{width}} {value}")


def _warn(log: Path, flight: FlightLog) -> int:
    """Prints warnings about an imported log on stderr; returns the exit code."""
    apart = velocity_disagreement(flight.motion)
    if apart is not None and apart[0] > max(MOST_DIFFERENT * apart[1], LEAST_DIFFERENCE):
        print(
            f"maneuver: {log}: velocities differ from what the positions show by {apart[0]:.2f} m/s at a "
            f"speed of {apart[1]:.2f} m/s: see --world, --body, --velocity-in, and --time-unit of tables",
            file=sys.stderr,
        )
    states = flight.motion
    if states.has_fields("roll", "pitch") and np.mean(np.cos(states["roll"]) * np.cos(states["pitch"])) < 0.0:
        print(f"maneuver: {log}: flies upside down most of the time: see --world and --body", file=sys.stderr)
    if flight.header.outcome != "completed":
        print(f"maneuver: {log}: {flight.header.outcome}", file=sys.stderr)
        return WITH_LOSS
    return 0
