"""Flight log of another vehicle's motion alone."""

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import MOTION

Column = Float[np.ndarray, "n"]


def motion_log(
    *,
    vehicle: str,
    time: Column,
    north: Column,
    east: Column,
    heading: Column,
    velocity: tuple[Column, Column] | None = None,
    yaw_rate: Column | None = None,
    wind: str = "not stated",
    name: str = "foreign",
) -> FlightLog:
    """Returns a log with `/motion` alone.

    Args:
        vehicle: name of the vehicle.
        time: seconds, increasing; shifted to start at 0.
        north: position, metres.
        east: position, metres.
        heading: radians, clockwise from north; it is unwrapped.
        velocity: north and east, metres per second; derivative of the position if None.
        yaw_rate: radians per second, clockwise; derivative of the heading if None.
        wind: wind class; logs of different wind classes are not identified together.
        name: name of the flight.

    Raises:
        FlightError: columns of different lengths, times that do not increase, values that are not finite.
    """
    columns = [north, east, heading, *(velocity or ()), *(() if yaw_rate is None else (yaw_rate,))]
    shapes = [np.shape(column) for column in columns]
    if any(shape != np.shape(time) or len(shape) != 1 for shape in shapes) or len(time) < 2:
        raise FlightError(f"expected columns of {len(time)} numbers, at least two, got {shapes}")
    if not (np.isfinite([time, *columns]).all() and (np.diff(time) > 0).all()):
        raise FlightError("expected finite numbers and increasing times")
    smooth = np.unwrap(heading)
    to_north, to_east = velocity or (np.gradient(north, time), np.gradient(east, time))
    cosine, sine = np.cos(smooth), np.sin(smooth)
    known = {
        "north": north,
        "east": east,
        "heading": smooth,
        "forward": cosine * to_north + sine * to_east,
        "side": cosine * to_east - sine * to_north,
        "yaw_rate": np.gradient(smooth, time) if yaw_rate is None else yaw_rate,
    }
    values = np.stack([known[field] for field in MOTION.field_names], axis=1)
    header = FlightHeader("foreign", name, vehicle, "not known", 0, wind, "not known", "not known")
    return FlightLog(header, {MOTION.name: Series(MOTION, time - time[0], values)}, {})
