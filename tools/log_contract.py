"""Writes the flight log's contract as a page: `python -m tools.log_contract`.

`--check` writes nothing and exits with 1 where the page is another.
"""

import argparse
import sys
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path

from flightlog import attachment_names
from flightlog.alarm import ALARM
from flightlog.channels import CONVENTIONS, TOPICS
from flightlog.decision import DECISION
from flightlog.header import FlightHeader
from flightlog.topic import Topic
from flightlog.viewers import z_up_frames as z_up
from flightlog.viewers.viewer_channels import VIEWER_TOPICS, ViewerTopic

PAGE = Path(__file__).parent.parent / "docs" / "flight-log.md"

HEAD = """# The flight log

One MCAP file a flight, written whole or not at all; it opens in Foxglove, Lichtblick, Rerun and PlotJuggler
as it is. Every channel is protobuf. Chunks are compressed by zstd; every checksum is written, and reading
verifies them all. Equal flights give equal bytes. A topic that is absent is absent, not zero; in a log of
another vehicle a field may be absent too: its schema lacks it, and the other fields keep their numbers.

There are two kinds of channels. The first are for programs: every field is a double, numbered in the order
below, in SI units, north-east-down; `flightlog.file.reader.read_log` reads them into arrays. The second are
for viewers: the well-known `foxglove` messages, made from the first when the log is written, z-up, and never
read back. [review.md](review.md) says how to open a log in the viewers.

This page is made from `flightlog/channels.py` and `flightlog/viewers/viewer_channels.py` by
`python -m tools.log_contract`.

## Example

```python
from pathlib import Path

from flightlog.channels import COMMAND, TRUTH
from flightlog.file.reader import read_log
from flightlog.primitives import primitives_flown

log = read_log(Path("flight.mcap"))
print(log.header.vehicle, log.header.wind, log.duration)
truth, command = log[TRUTH], log[COMMAND]
print(truth.time[-1], truth["forward"].max(), truth["down"][-1], command["yaw_rate"][-1])
for part in primitives_flown(log):
    print(part.kind.name, part.id, part.start, part.end)
```

Any other reader of MCAP and protobuf gives the same numbers: schemas are in the file.
"""

ATTACHMENTS = (
    (attachment_names.LIBRARY_ATTACHMENT, "the library flown with; carries the maneuver-end rule"),
    (attachment_names.SPECIFICATION_ATTACHMENT, "all that the simulator needs to repeat the flight"),
    (attachment_names.VEHICLE_ATTACHMENT, "every number of the vehicle that flew"),
    (attachment_names.IMPORT_ATTACHMENT, "where a log that another program wrote came from"),
    (attachment_names.MODEL_ATTACHMENT, "its shape, as MuJoCo's MJCF: x forward, y left, z up"),
    (
        attachment_names.INITIAL_STATE_ATTACHMENT,
        "the true state at time 0; with controls and wind it gives the motion",
    ),
    (
        attachment_names.FAULTS_ATTACHMENT,
        "what goes wrong: where, what, start and duration in s, sizes; absent in most",
    ),
    (
        attachment_names.MISSION_ATTACHMENT,
        "the mission of a flight in receding horizon, its planner and settings",
    ),
    (
        attachment_names.PLANS_ATTACHMENT,
        "its plans, in order, each `maneuver-plan/1` with when it was asked for and how long that took",
    ),
)


def page() -> str:
    """Returns the page."""
    return "\n".join(
        [HEAD, *map(_topic, (*TOPICS, DECISION, ALARM)), _viewers(), _metadata(), _attachments()]
    )


def _topic(topic: Topic) -> str:
    rows = ((f"`{field.name}`", field.unit, field.meaning) for field in topic.fields)
    return f"## `{topic.name}`\n\n`{topic.message}`: {topic.meaning}.\n\n" + _table(
        ("field", "unit", "meaning"), rows
    )


def _viewers() -> str:
    def row(topic: ViewerTopic) -> tuple[str, ...]:
        return f"`{topic.name}`", f"`{topic.message.DESCRIPTOR.full_name}`", topic.meaning

    frames = (
        f"World `{z_up.WORLD}`, x east, y north, z up; vehicle `{z_up.VEHICLE}` and, where it believes "
        f"to be, `{z_up.ESTIMATED_VEHICLE}`, x forward, y left, z up."
    )
    return f"## For viewers\n\n{frames}\n\n" + _table(
        ("topic", "message", "what is to be seen"), map(row, VIEWER_TOPICS)
    )


def _metadata() -> str:
    header = ", ".join(field.name for field in fields(FlightHeader))
    text = f"`flight` is the header: {header}. `conventions` says, for who has the file alone:"
    return f"## Metadata\n\n{text}\n\n" + _table(("key", "value"), CONVENTIONS.items())


def _attachments() -> str:
    rows = ((f"`{name}`", meaning) for name, meaning in ATTACHMENTS)
    return "## Attachments\n\n" + _table(("name", "content"), rows)


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def main() -> int:
    """Writes the page, or compares one; returns the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", nargs="?", type=Path, const=PAGE, metavar="PAGE", help=f"docs/{PAGE.name}")
    checked: Path | None = parser.parse_args().check
    if checked is None:
        PAGE.write_text(page(), encoding="utf-8")
    elif checked.read_text(encoding="utf-8") != page():
        print(
            f"{checked.name} is not the log's contract; `python -m tools.log_contract` writes it",
            file=sys.stderr,
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
