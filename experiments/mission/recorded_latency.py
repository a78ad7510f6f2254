"""Planning latencies recorded in a flight log."""

import json

from pydantic import BaseModel, ConfigDict, NonNegativeFloat, TypeAdapter, ValidationError

from flight.errors import BadFileError
from flight.schema import first_problem
from flightlog.attachment_names import MISSION_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.log import FlightLog
from planner.closed_loop.latency import Latency


class _Part(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)


class _Latency(_Part):
    configured: NonNegativeFloat
    measured: bool


class _Settings(_Part):
    latency: _Latency


class _Mission(_Part):
    settings: _Settings


class _Plan(_Part):
    latency: NonNegativeFloat


def recorded_latency(log: FlightLog, *, source: str) -> Latency:
    """Returns the latencies of a logged flight, for a repetition.

    Raises:
        BadFileError: the log has no mission with settings, or no plans with latencies.
    """
    try:
        settings = _Mission.model_validate(json.loads(log.attachments[MISSION_ATTACHMENT])).settings
        plans = TypeAdapter(tuple[_Plan, ...]).validate_python(json.loads(log.attachments[PLANS_ATTACHMENT]))
    except KeyError as error:
        raise BadFileError(source, f"expected a log of a mission, it has no {error.args[0]}") from None
    except ValidationError as error:
        raise BadFileError(source, first_problem(error)) from None
    recorded = tuple(plan.latency for plan in plans)
    return Latency(settings.latency.configured, settings.latency.measured, recorded)
