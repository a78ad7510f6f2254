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
from flightlog.decision import DECISION
from flightlog.header import FlightHeader
from flightlog.series import Topic
from flightlog.topics import CONVENTIONS, TOPICS
from flightlog.viewers import z_up_frames as z_up
from flightlog.viewers.viewer_channels import VIEWER_TOPICS, ViewerTopic

PAGE = Path(__file__).parent.parent / "docs" / "flight-log.md"

HEAD = """# The flight log

One MCAP file for each flight, written atomically; it opens in Foxglove, Lichtblick, Rerun and PlotJuggler.
Every channel is protobuf. Chunks are compressed by zstd; every checksum is written, and the reader verifies
all of them. Equal flights give equal bytes. Missing topics are absent, not zero. In a log of another vehicle
fields may be absent too: its schema lacks them, and the other fields keep their numbers.

There are two kinds of channels. The first are for programs: every field is a double, numbered in the order
below, in SI units, north-east-down; `flightlog.file.reader.read_log` reads them into arrays. The second are
for viewers: the well-known `foxglove` messages, made from the first when the log is written, z-up, and never
read back. [review.md](review.md) says how to open a log in the viewers.

This page is made from `flightlog/topics.py` and `flightlog/viewers/viewer_channels.py` by
`python -m tools.log_contract`.

## Example

```python
from pathlib import Path

from flightlog.topics import COMMAND, TRUTH
from flightlog.file.reader import read_log
from flightlog.primitives import flown_primitives

log = read_log(Path("flight.mcap"))
print(log.header.vehicle, log.header.wind, log.duration)
truth, command = log[TRUTH], log[COMMAND]
print(truth.time[-1], truth["forward"].max(), truth["down"][-1], command["yaw_rate"][-1])
for part in flown_primitives(log):
    print(part.kind.name, part.id, part.start, part.end)
```

Any other reader of MCAP and protobuf gives the same numbers; the schemas are in the file.
"""

ATTACHMENTS = (
    (attachment_names.LIBRARY_ATTACHMENT, "library flown with, including the maneuver-end rule"),
    (attachment_names.SPECIFICATION_ATTACHMENT, "input of the simulator that repeats the flight"),
    (attachment_names.VEHICLE_ATTACHMENT, "all parameters of the vehicle"),
    (attachment_names.IMPORT_ATTACHMENT, "origin of an imported log"),
    (attachment_names.MODEL_ATTACHMENT, "shape of the vehicle as MuJoCo's MJCF: x forward, y left, z up"),
    (
        attachment_names.INITIAL_STATE_ATTACHMENT,
        "true state at time 0; with controls and wind it reproduces the motion",
    ),
    (
        attachment_names.FAULTS_ATTACHMENT,
        "injected faults: place, kind, start and duration in s, sizes; absent without faults",
    ),
    (
        attachment_names.MISSION_ATTACHMENT,
        "mission of a receding-horizon flight, its planner and settings",
    ),
    (
        attachment_names.MISSION_PLAN_ATTACHMENT,
        "plan for the mission as stated, a `maneuver-plan/2`; its cost is the planned time",
    ),
    (
        attachment_names.POLICY_ATTACHMENT,
        "instead of plans, what the policy with feedback states, its table named: a `maneuver-policy/1`",
    ),
    (
        attachment_names.PLANS_ATTACHMENT,
        "its plans in order, each `maneuver-plan/1` with time and duration of the planning",
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
        f"World `{z_up.WORLD}`: x east, y north, z up. Vehicle `{z_up.VEHICLE}` (true pose) and "
        f"`{z_up.ESTIMATED_VEHICLE}` (estimated pose): x forward, y left, z up."
    )
    return f"## For viewers\n\n{frames}\n\n" + _table(
        ("topic", "message", "content"), map(row, VIEWER_TOPICS)
    )


def _metadata() -> str:
    header = ", ".join(field.name for field in fields(FlightHeader))
    text = f"`flight` is the header: {header}. `conventions` states the conventions of the file:"
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
