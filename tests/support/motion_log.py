"""A flight log from motion alone: what another vehicle, simulator or camera system knows of a flight."""

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flightlog.channels import MOTION
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.topic import Series

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
    """Returns a log that holds nothing but `/motion`.

    Args:
        vehicle: what flew.
        time: seconds, increasing; the log begins at 0.
        north: position, metres.
        east: position, metres.
        heading: radians, clockwise from north; jumps by whole turns are taken out.
        velocity: north and east, metres per second; the slope of the position where None.
        yaw_rate: radians per second, clockwise; the slope of the heading where None.
        wind: what is known of it; logs of different wind make no library together.
        name: of the flight.

    Raises:
        FlightError: columns of different lengths, times that do not increase, values that are not finite.
    """
    columns = [north, east, heading, *(velocity or ()), *(() if yaw_rate is None else (yaw_rate,))]
    if any(np.shape(one) != np.shape(time) or np.ndim(one) != 1 for one in columns) or len(time) < 2:
        raise FlightError(
            f"expected columns of {len(time)} numbers, two at least, got {[np.shape(one) for one in columns]}"
        )
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
