"""Headings of a table: our names for them, and their units."""

import re
from collections.abc import Iterable, Mapping, Sequence

from flight.errors import FlightError
from flightlog.imports.clock import SECONDS, TimeUnit
from flightlog.imports.motion.units import ANGLES, LENGTHS, RATES, SPEEDS, Quantity
from flightlog.topics import MAX_ACTUATORS

POSITION, VELOCITY, RATE_NAMES = ("x", "y", "z"), ("vx", "vy", "vz"), ("wx", "wy", "wz")
QUATERNION, ANGLE_NAMES = ("qw", "qx", "qy", "qz"), ("roll", "pitch", "yaw")
GEODETIC = ("lat", "lon", "alt")
CONTROLS = tuple(f"u{number}" for number in range(1, MAX_ACTUATORS + 1))
NAMES = (
    *("time", *POSITION, *VELOCITY, *QUATERNION, *ANGLE_NAMES, *RATE_NAMES),
    *(*CONTROLS, *GEODETIC, "id"),
)
"""Names of columns: position and velocity in SI units (z and vz optional), quaternion or angles (about z, y,
x; yaw may be alone) from body to world, body rates, controls, latitude and longitude in degrees, vehicle."""

MEASURED: dict[str, Quantity] = {
    **dict.fromkeys((*POSITION, "alt"), "length"),
    **dict.fromkeys(VELOCITY, "speed"),
    **dict.fromkeys(ANGLE_NAMES, "angle"),
    **dict.fromkeys(RATE_NAMES, "rate"),
    "time": "time",
}
"""Quantities of the columns that have units."""

TIME_UNITS: dict[str, TimeUnit] = {
    **{"s": "s", "sec": "s", "secs": "s", "seconds": "s", "ms": "ms", "msec": "ms"},
    **{"us": "us", "usec": "us", "µs": "us", "ns": "ns", "nsec": "ns"},
}
"""Units of time by the names that they have in headings."""

_SIZES: dict[Quantity, Mapping[str, float]] = {
    **{"length": LENGTHS, "speed": SPEEDS, "angle": ANGLES, "rate": RATES},
    "time": {name: SECONDS[unit] for name, unit in TIME_UNITS.items()},
}
_OTHER_UNITS = frozenset(
    {"-", "1", "none", "bool", "%", "v", "a", "m/s2", "m/s^2", "m/s/s", "n", "nm", "pa", "c", "k", "hz", "g"}
)
_LIKELY = {
    "time": ("t", "timestamp", "stamp", "sec", "seconds", "time_s", "timestamps"),
    "x": ("north", "pos_x", "px", "position_x", "pn", "x_m"),
    "y": ("east", "pos_y", "py", "position_y", "pe"),
    "z": ("down", "height", "altitude", "pos_z", "pz", "position_z", "pd"),
    "vx": ("vn", "vel_x", "velocity_x", "v_x", "v_north"),
    "vy": ("ve", "vel_y", "velocity_y", "v_y", "v_east"),
    "vz": ("vd", "vel_z", "velocity_z", "v_z", "v_down"),
    "body vx": ("u",),
    "body vy": ("v",),
    "body vz": ("w",),
    "roll": ("phi", "roll_angle", "bank"),
    "pitch": ("theta", "pitch_angle"),
    "yaw": ("heading", "psi", "hdg", "azimuth", "yaw_angle"),
    "wx": ("p", "gyro_x", "ang_vel_x", "roll_rate", "rollspeed"),
    "wy": ("q", "gyro_y", "ang_vel_y", "pitch_rate", "pitchspeed"),
    "wz": ("r", "gyro_z", "ang_vel_z", "yaw_rate", "yawspeed"),
    "qw": ("q0", "q_w", "quat_w"),
    "qx": ("q1", "q_x", "quat_x"),
    "qy": ("q2", "q_y", "quat_y"),
    "qz": ("q3", "q_z", "quat_z"),
    "lat": ("latitude",),
    "lon": ("longitude", "lng"),
    "id": ("vehicle", "vehicle_id", "sysid", "agent", "drone", "robot", "uav"),
}
_BRACKETED = re.compile(r"(.+?)\s*[\[(]([^\])]*)[\])]")
_MOST_LISTED, _LONGEST_LIST = 40, 600


def is_unit(cell: str) -> bool:
    """Returns True for the name of a unit, in brackets or not."""
    name = cell.strip("[]() ").lower()
    return name in _OTHER_UNITS or any(name in sizes for sizes in _SIZES.values())


def split_heading(heading: str) -> tuple[str, str]:
    """Returns a heading and its unit, apart, in lower case."""
    found = _BRACKETED.fullmatch(heading)
    if found:
        return found[1].strip().lower(), found[2].strip().lower()
    stem, _, ending = heading.lower().rpartition("_")
    return (stem, ending) if stem in NAMES and is_unit(ending) else (heading.strip().lower(), "")


def select_columns(headings: Sequence[str], stated: Mapping[str, str]) -> dict[str, int]:
    """Returns places of columns by our names, stated or equal.

    Raises:
        FlightError: a stated column is absent, a heading stands twice, or there is no time.
    """
    chosen = {}
    for name, heading in stated.items():
        if name not in NAMES:
            raise FlightError(f"unknown column name {name!r}; expected one of {', '.join(NAMES)}")
        chosen[name] = place_of(headings, heading)
    for place, heading in enumerate(headings):
        name = split_heading(heading)[0]
        if name not in NAMES or name in stated:
            continue
        if name in chosen:
            raise FlightError(
                f"two columns are named {name}: give --columns {name}=#{chosen[name] + 1} or #{place + 1}"
            )
        chosen[name] = place
    return chosen


def place_of(headings: Sequence[str], heading: str) -> int:
    """Returns the place of a stated heading, or of `#N`.

    Raises:
        FlightError: there is none, or several.
    """
    if heading in headings:
        if headings.count(heading) > 1:
            raise FlightError(f"{headings.count(heading)} columns are named {heading!r}: give #N, N from 1")
        return headings.index(heading)
    if re.fullmatch(r"#[1-9]\d{0,4}", heading):
        return int(heading[1:]) - 1
    raise FlightError(f"no column {heading!r}; it has {heading_list(headings)}")


def unit_of(name: str, heading: str, row: str, stated: Mapping[Quantity, str]) -> tuple[str, float] | None:
    """Returns a column's unit and size in SI, if stated.

    Args:
        name: our name of the column.
        heading: heading of the column, which may hold its unit.
        row: unit in the row of units, if any.
        stated: units of options by quantity; they come first.

    Raises:
        FlightError: the table states a unit that is not known.
    """
    quantity = MEASURED.get(name)
    if quantity is None:
        return None
    sizes = _SIZES[quantity]
    option = stated.get(quantity, "")
    unit = option or split_heading(heading)[1] or row.strip("[]() ").lower()
    if not unit:
        return None
    if unit not in sizes:
        raise FlightError(
            f"column {heading!r}: expected a unit of {', '.join(sizes)}, got {unit!r}: give --{quantity}-unit"
        )
    return unit, sizes[unit]


def guesses(headings: Iterable[str]) -> list[str]:
    """Returns headings with the name that each could have."""
    found = []
    for heading in headings:
        bare = split_heading(heading)[0].replace(" ", "_")
        likely = next((name for name, others in _LIKELY.items() if bare in others), None)
        found.append(f"{heading} (could be {likely})" if likely else heading)
    return found


def heading_list(headings: Sequence[str]) -> str:
    """Returns headings as one line of limited length."""
    return " ".join(", ".join(headings[:_MOST_LISTED]).split())[:_LONGEST_LIST] or "none"
