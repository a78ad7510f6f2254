"""Planning latencies recorded in a flight log."""

from dataclasses import replace

from flight.errors import BadFileError
from flight.schema import parse_json
from flightlog.attachment_names import MISSION_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.mission_attachments import logged_plannings
from planner.closed_loop.latency import Latency

from .mission_log import PlanningSettings


def recorded_latency(log: FlightLog, *, source: str) -> Latency:
    """Returns the latencies of a logged flight, for a repetition.

    Raises:
        BadFileError: the log has no mission with settings, or no plans with latencies.
    """
    for name in (MISSION_ATTACHMENT, PLANS_ATTACHMENT):
        if name not in log.attachments:
            raise BadFileError(source, f"expected the log of a mission's flight, got one without {name}")
    logged = parse_json(
        log.attachments[MISSION_ATTACHMENT], MISSION_ATTACHMENT, PlanningSettings, extra="ignore"
    )
    recorded = tuple(planning.latency for planning in logged_plannings(log))
    return replace(logged.settings.latency, recorded=recorded)
