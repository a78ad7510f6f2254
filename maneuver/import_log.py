"""`maneuver import`: a flight log of PX4 as one of ours."""

import json as json_module
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from flight.errors import FlightError
from flight.log import TOPICS
from flight.log_file import publish_log
from flight.px4_log import read_px4_log

from .files import refuse_existing


def import_log(
    log: Path,
    /,
    *,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Makes a flight log of a ULog of PX4, for review and the viewers.

    The estimate comes from vehicle_local_position, vehicle_attitude and vehicle_angular_velocity, the truth
    from their ground truths where a simulator logged them, the command from vehicle_local_position_setpoint.
    What the log does not hold is absent, not zero; heights are above PX4's own origin.

    For example:

        maneuver import flight.ulg

        maneuver import flight.ulg --out flight.mcap && maneuver review flight.mcap --html

    Args:
        log: a ULog, FLIGHT.ulg.
        out: flight log to write; LOG's name with .mcap by default.
        force: overwrite OUT.
        json: print what came of it as JSON.
    """
    if log.suffix != ".ulg":
        raise FlightError(f"expected the name of a ULog, FLIGHT.ulg, got {log}")
    path = out or Path(f"{log.stem}.mcap")
    refuse_existing(path, force=force)
    flight = read_px4_log(log)
    publish_log(flight, path, force=force)
    held = [name for name in (topic.name for topic in TOPICS) if name in flight.series]
    absent = [topic.name for topic in TOPICS if topic.name not in flight.series]
    if json:
        print(
            json_module.dumps({"log": str(path), "duration": flight.duration, "held": held, "absent": absent})
        )
        return 0
    print(f"{'log':<10} {path}\n{'duration':<10} {flight.duration:.2f} s")
    print(f"{'held':<10} {', '.join(held)}\n{'absent':<10} {', '.join(absent)}")
    return 0
