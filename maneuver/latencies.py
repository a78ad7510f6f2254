"""Latency on the command line: seconds, the clock's, or those of a flight that is to be repeated."""

import json
from pathlib import Path

from pydantic import BaseModel, ConfigDict, NonNegativeFloat, TypeAdapter, ValidationError

from flight.errors import BadFileError, FlightError
from flight.file_model import first_problem
from flight.log import MISSION_ATTACHMENT, PLANS_ATTACHMENT, FlightLog
from flight.log_file import read_log
from planner.latency import Latency

MEASURED = "measured"


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


def latency_of(text: str) -> Latency:
    """Returns what is charged for each planning.

    Args:
        text: seconds, `measured`, or the path of a flight log, whose latencies are charged again.

    Raises:
        FlightError: it is none of these, or the log says nothing of latencies.
    """
    if text == MEASURED:
        return Latency(measured=True)
    path = Path(text)
    if path.suffix == ".mcap":
        return recorded_latency(read_log(path), source=text)
    try:
        return Latency(float(text))
    except ValueError as error:
        problem = str(error) if str(error).startswith("latency") else f"got {text!r}"
        raise FlightError(
            f"--latency: expected seconds, {MEASURED!r} or the log of a flight to be repeated: {problem}"
        ) from None


def recorded_latency(log: FlightLog, *, source: str) -> Latency:
    """Returns the latencies of a flight, so that they can be charged again.

    Raises:
        BadFileError: the log carries no mission with settings, or no plans with latencies.
    """
    try:
        settings = _Mission.model_validate(json.loads(log.attachments[MISSION_ATTACHMENT])).settings
        plans = TypeAdapter(tuple[_Plan, ...]).validate_python(json.loads(log.attachments[PLANS_ATTACHMENT]))
    except KeyError as error:
        raise BadFileError(source, f"is no flight of a mission: it has no {error.args[0]}") from None
    except ValidationError as error:
        raise BadFileError(source, first_problem(error)) from None
    recorded = tuple(plan.latency for plan in plans)
    return Latency(settings.latency.configured, settings.latency.measured, recorded)
