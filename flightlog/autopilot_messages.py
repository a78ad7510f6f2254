"""What an autopilot of another kind told while it flew: its own messages, in the log that was made of its."""

import json
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, FiniteFloat, TypeAdapter, ValidationError

from flight.errors import BadFileError
from flight.schema import first_problem

from .attachment_names import IMPORT_ATTACHMENT
from .log import FlightLog


@dataclass(frozen=True, slots=True)
class AutopilotMessage:
    """One message: seconds since the log's start (below 0 before it), `INFO`, `WARNING` or `ERROR`, words."""

    time: float
    level: str
    text: str


class _Message(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)

    time: FiniteFloat
    level: str
    text: str


class _Import(BaseModel):
    model_config = ConfigDict(extra="ignore", frozen=True)

    messages: tuple[_Message, ...] = ()


def autopilot_messages(log: FlightLog) -> tuple[AutopilotMessage, ...]:
    """Returns the autopilot's messages; none in a log that was not imported.

    Raises:
        BadFileError: the attachment is there, but broken.
    """
    if IMPORT_ATTACHMENT not in log.attachments:
        return ()
    try:
        content = TypeAdapter(_Import).validate_python(json.loads(log.attachments[IMPORT_ATTACHMENT]))
    except ValidationError as error:
        raise BadFileError(IMPORT_ATTACHMENT, first_problem(error)) from None
    except ValueError as error:
        raise BadFileError(IMPORT_ATTACHMENT, f"is not JSON: {error}") from None
    return tuple(AutopilotMessage(one.time, one.level, one.text) for one in content.messages)
