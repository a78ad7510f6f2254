"""Status messages of an imported log's autopilot."""

from dataclasses import dataclass

from flight.schema import FileModel, parse_json

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


class _Import(FileModel):
    messages: tuple[AutopilotMessage, ...] = ()


def autopilot_messages(log: FlightLog) -> tuple[AutopilotMessage, ...]:
    """Returns the autopilot's messages; none unless the log was imported.

    Raises:
        BadFileError: the attachment is invalid.
    """
    text = log.attachments.get(IMPORT_ATTACHMENT)
    return () if text is None else parse_json(text, IMPORT_ATTACHMENT, _Import, extra="ignore").messages
