"""Writes the flight log's contract as a page: `python -m tools.log_contract`."""

from pathlib import Path

from flight import log
from flight.decision import DECISION
from flight.log import TOPICS, Topic

PAGE = Path(__file__).parent.parent / "docs" / "flight-log.md"

HEAD = """# The flight log

One MCAP file a flight, written whole or not at all. Channels are protobuf, every field a double, numbered in
the order below; chunks are compressed by zstd; every checksum is written, and reading verifies them all. Log
time and publish time are equal: nanoseconds since the flight's start, simulated, never of the wall clock.

World axes are north, east, down. Velocities are given in the heading frame, the level body frame: forward
along the heading, side to the right. Angles are in radians, headings clockwise from north and not wrapped.

The metadata record `flight` holds the header: kind, name, vehicle, model_hash, seed, wind, code_version,
backend, outcome. A topic that is absent is absent, not zero.

This page is made from `flight/log.py` by `python -m tools.log_contract`.
"""

ATTACHMENTS = (
    (log.LIBRARY_ATTACHMENT, "the library flown with; carries the maneuver-end rule"),
    (log.SPECIFICATION_ATTACHMENT, "all that the simulator needs to repeat the flight"),
    (log.INITIAL_STATE_ATTACHMENT, "the true state at time 0; with controls and wind it gives the motion"),
    (log.MISSION_ATTACHMENT, "the mission of a flight in receding horizon, its planner and settings"),
    (
        log.PLANS_ATTACHMENT,
        "its plans, in order, each `maneuver-plan/1` with when it was asked for and how long that took",
    ),
)


def page() -> str:
    """Returns the page."""
    rows = "\n".join(f"| `{name}` | {meaning} |" for name, meaning in ATTACHMENTS)
    attachments = f"## Attachments\n\n| name | content |\n| --- | --- |\n{rows}\n"
    return "\n".join([HEAD, *map(_section, (*TOPICS, DECISION)), attachments])


def _section(topic: Topic) -> str:
    rows = "\n".join(f"| `{field.name}` | {field.unit} | {field.meaning} |" for field in topic.fields)
    head = f"## `{topic.name}`\n\n`{topic.message}`: {topic.meaning}.\n"
    return f"{head}\n| field | unit | meaning |\n| --- | --- | --- |\n{rows}\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
