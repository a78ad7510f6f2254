"""Control limits of the vehicle in a log."""

import json

from flightlog.attachment_names import VEHICLE_ATTACHMENT
from flightlog.log import FlightLog

Limits = dict[str, tuple[float, float]]


def control_limits(log: FlightLog) -> Limits:
    """Returns control limits in radians by field; empty where unknown."""
    if VEHICLE_ATTACHMENT not in log.attachments:
        return {}
    try:
        servos = json.loads(log.attachments[VEHICLE_ATTACHMENT])["servos"]
        cyclic = (-float(servos["cyclic_limit"]), float(servos["cyclic_limit"]))
        return {
            "collective": (float(servos["collective_low"]), float(servos["collective_high"])),
            "longitudinal": cyclic,
            "lateral": cyclic,
            "pedal": (float(servos["pedal_low"]), float(servos["pedal_high"])),
        }
    except (ValueError, KeyError, TypeError):
        return {}
