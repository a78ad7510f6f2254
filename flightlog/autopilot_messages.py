"""Status messages of an imported log's autopilot."""

import json
from dataclasses import dataclass

from pydantic import BaseModel, ConfigDict, FiniteFloat, TypeAdapter, ValidationError

from flight.errors import BadFileError
from flight.schema import first_problem

from .attachment_names import IMPORT_ATTACHMENT
from .log import FlightLog


@dataclass(frozen=True, slots=True)
class AutopilotMessage:
    """Autopilot message: time, level and text.

    Attributes:
        time: seconds since the log's start; negative before it.
        level: `INFO`, `WARNING` or `ERROR`.
        text: the message.
    """

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
    """Returns the autopilot's messages; none unless the log was imported.

    Raises:
        BadFileError: the attachment is invalid.
    """
    if IMPORT_ATTACHMENT not in log.attachments:
        return ()
    try:
        content = TypeAdapter(_Import).validate_python(json.loads(log.attachments[IMPORT_ATTACHMENT]))
    except ValidationError as error:
        raise BadFileError(IMPORT_ATTACHMENT, first_problem(error)) from None
    except ValueError as error:
        raise BadFileError(IMPORT_ATTACHMENT, f"is not JSON: {error}") from None
    return tuple(AutopilotMessage(part.time, part.level, part.text) for part in content.messages)
