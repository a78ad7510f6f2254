"""What an autopilot of another kind told while it flew: its own messages, in the log that was made of its."""

from dataclasses import dataclass

from flight.schema import FileModel, parse_json

from .attachment_names import IMPORT_ATTACHMENT
from .log import FlightLog


@dataclass(frozen=True, slots=True)
class AutopilotMessage:
    """One message: seconds since the log's start (below 0 before it), `INFO`, `WARNING` or `ERROR`, words."""

    time: float
    level: str
    text: str


class _Import(FileModel):
    messages: tuple[AutopilotMessage, ...] = ()


def autopilot_messages(log: FlightLog) -> tuple[AutopilotMessage, ...]:
    """Returns the autopilot's messages; none in a log that was not imported.

    Raises:
        BadFileError: the attachment is there, but broken.
    """
    text = log.attachments.get(IMPORT_ATTACHMENT)
    return () if text is None else parse_json(text, IMPORT_ATTACHMENT, _Import, extra="ignore").messages
