"""Import of MCAP files and ROS bags as flight logs."""

import struct
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import zstandard
from google.protobuf.message import DecodeError
from mcap.exceptions import McapError

from flight.errors import BadFileError, FlightError
from flightlog.log import FlightLog
from flightlog.series import Topic

from .axes import BodyAxes, WorldAxes
from .bags.bag_clock import clocks_of
from .bags.bag_sources import SLOPE, AlignedTopic, bag_sources, default_frames
from .bags.mcap_file import McapBag
from .bags.raw_message import Bag
from .bags.topic_columns import TopicColumns
from .clock import Part
from .imported_log import ExternalLog, LeftOut
from .mcap_messages import child_frame_of, frame_of, transforms_of
from .measured_motion import Source, measured_states
from .motion.frames import Frames, QuaternionOrder, VelocityAxes, check_frames, guess_quaternion_order
from .motion.resets import counter_breaks, jumps, merged

_MOST_LISTED = 12
_MOST_BAD = 0.5
_UNREADABLE = (
    *(McapError, DecodeError, ValueError, KeyError, TypeError, AttributeError, EOFError, IndexError),
    *(struct.error, zstandard.ZstdError, MemoryError, OverflowError, RuntimeError, AssertionError),
)
_LIKELY = (
    "Odometry",
    "PoseStamped",
    "PoseWithCovarianceStamped",
    "TransformStamped",
    "TFMessage",
    "NavSatFix",
)
_LIKELY_TOO = ("VehicleLocalPosition", "PoseInFrame", "LocationFix", "VehicleOdometry")


@dataclass(frozen=True, slots=True)
class McapImportSettings:
    """Topics and axes of an import; None for those of the messages.

    Attributes:
        pose: topic of positions and attitudes.
        velocity: topic of velocities; if None those of the pose topic, or the derivative of the position.
        world: axes of the world.
        body: axes of the body.
        velocity_in: axes of the velocities: world or body.
        quaternion: order of quaternions in lists.
        child_frame: child frame of the vehicle, of several.
        frames: frame and child frame of transforms.
        part: number of the part, of several.
        unchecked: True to read numbers that contradict one another.
    """

    pose: str | None = None
    velocity: str | None = None
    world: WorldAxes | None = None
    body: BodyAxes | None = None
    velocity_in: VelocityAxes | None = None
    quaternion: QuaternionOrder | None = None
    child_frame: str | None = None
    frames: tuple[str, str] | None = None
    part: int | None = None
    unchecked: bool = False


@dataclass(slots=True, eq=False)
class _Pairs:
    """Pairs of frames of transforms, by number of messages."""

    counts: dict[tuple[str, str], int] = field(default_factory=dict)


def read_external_mcap(
    path: Path, settings: McapImportSettings, *, topic: Topic, bag: Bag | None = None
) -> FlightLog:
    """Reads pose and velocity topics in ROS, protobuf or JSON messages.

    Times are the stamps of the messages, or the log times if a topic has no stamps or they jump. Without
    velocities the position is differentiated. The attachment records these choices.

    Args:
        path: file to read.
        settings: topics and axes.
        topic: topic of the motion: estimate or truth.
        bag: messages of the file; those of an MCAP file if None.

    Raises:
        BadFileError: the file is damaged, lacks the topics, or they hold no motion.
    """
    try:
        return _read(path, settings, topic, bag or McapBag(path))
    except BadFileError:
        raise
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    except _UNREADABLE as error:
        text = " ".join(str(error).split()) or type(error).__name__
        advice = "; `maneuver recover` saves the undamaged part" if bag is None else ""
        raise BadFileError(path, f"cannot be read: {text}{advice}") from None


def _read(path: Path, settings: McapImportSettings, topic: Topic, bag: Bag) -> FlightLog:
    topics = bag.topics()
    if settings.pose is None:
        raise FlightError(
            f"expected --pose TOPIC, and --velocity TOPIC where that is another one; {_listed(topics)}"
        )
    names = list(dict.fromkeys([settings.pose, *([settings.velocity] if settings.velocity else [])]))
    for name in names:
        if name not in topics:
            raise FlightError(f"no topic {name}; {_listed(topics)}")
    tables = _gather(bag, names, settings)
    parts, clock = clocks_of(tables, settings.part)
    start = min(part.time[0] for part in parts.values())
    aligned = {
        name: AlignedTopic(table, parts[name].rows, parts[name].time - start)
        for name, table in tables.items()
    }
    pose, moving = aligned[settings.pose], aligned[settings.velocity or settings.pose]
    frames = default_frames(pose, moving)
    given = {
        name: value
        for name in ("world", "body", "velocity_in", "quaternion")
        if (value := getattr(settings, name)) is not None
    }
    frames = replace(frames, **given)

    def build(axes: Frames) -> list[Source]:
        return bag_sources(pose, moving, axes)[0]

    if settings.quaternion is None and pose.has_listed_quaternion and not pose.table.px4:
        frames = replace(frames, quaternion=guess_quaternion_order(build, frames))
    sources, said = bag_sources(pose, moving, frames)
    if settings.velocity and said.get("velocity", "absent") in {"absent", SLOPE}:
        raise FlightError(f"{settings.velocity} ({moving.table.schema}): expected a velocity, got none")
    if not settings.unchecked:
        check_frames(build, frames)
    states = measured_states(sources, topic)
    if states is None:
        raise FlightError(f"expected a motion in {names}, got fewer than two usable messages")
    provenance: dict[str, object] = {
        "pose": f"{settings.pose} ({pose.table.schema})",
        "velocity": f"{settings.velocity or settings.pose}, along the axes of the {frames.velocity_in}",
        "world axes": frames.world,
        "body axes": frames.body,
        "times": clock,
        **({"quaternions": f"lists of {frames.quaternion}"} if pose.has_listed_quaternion else {}),
        **said,
    }
    breaks = [
        *jumps(sources),
        *(each for table in aligned.values() for each in counter_breaks(table.time, table.counters())),
    ]
    left_out = [each for name, part in parts.items() for each in _left_out(tables[name], part)]
    return ExternalLog(path).log([states], provenance=provenance, breaks=merged(breaks), left_out=left_out)


def _gather(bag: Bag, names: list[str], settings: McapImportSettings) -> dict[str, TopicColumns]:
    """Returns the numbers of the topics' messages, read one after another.

    Raises:
        FlightError: a topic has no messages, or those of several vehicles.
    """
    tables: dict[str, TopicColumns] = {}
    pairs = _Pairs()
    for raw in bag.messages(names):
        table = tables.get(raw.topic)
        if table is None:
            table = tables[raw.topic] = TopicColumns(raw.topic, raw.schema, settings.child_frame)
        try:
            message = raw.decode()
        except Exception:
            # A decoder of damaged bytes may raise anything.
            table.bad += 1
            continue
        inner = transforms_of(message)
        if inner is None:
            table.add(message, raw.logged)
            continue
        for each in inner:
            pair = frame_of(each), child_frame_of(each)
            pairs.counts[pair] = pairs.counts.get(pair, 0) + 1
            if settings.frames and pair == tuple(name.lstrip("/") for name in settings.frames):
                table.add(each, raw.logged)
    if pairs.counts and (not settings.frames or not all(len(table) for table in tables.values())):
        listed = [f"{frame} {child} ({count})" for (frame, child), count in sorted(pairs.counts.items())]
        raise FlightError(f"transforms: give --frames FRAME CHILD, one of {', '.join(listed[:_MOST_LISTED])}")
    for name in names:
        table = tables.get(name)
        if table is not None and table.children and not len(table):
            raise FlightError(
                f"{name}: no child frame {settings.child_frame}; it has {', '.join(sorted(table.children))}"
            )
        if table is None or not len(table):
            bad = f", and {table.bad} that cannot be decoded" if table is not None and table.bad else ""
            raise FlightError(f"expected messages in {[name]}, got none{bad}")
        if table.bad > _MOST_BAD * len(table):
            raise FlightError(f"{name}: {table.bad} of {table.bad + len(table)} messages cannot be decoded")
        if settings.child_frame is None and len(table.children) > 1:
            listed = [f"{child or 'none'} ({count})" for child, count in sorted(table.children.items())]
            raise FlightError(
                f"{name} has several vehicles: give --child-frame, one of {', '.join(listed[:_MOST_LISTED])}"
            )
    return tables


def _listed(topics: Mapping[str, str]) -> str:
    """Returns the topics in words, those that may be poses first."""
    likely = [
        f"{name} ({schema})"
        for name, schema in sorted(topics.items())
        if schema.endswith((*_LIKELY, *_LIKELY_TOO))
    ]
    others = [
        f"{name} ({schema})" for name, schema in sorted(topics.items()) if f"{name} ({schema})" not in likely
    ]
    listed = [*likely, *others]
    more = f" and {len(listed) - _MOST_LISTED} more" if len(listed) > _MOST_LISTED else ""
    return f"it has {', '.join(listed[:_MOST_LISTED]) or 'none'}{more}"


def _left_out(table: TopicColumns, part: Part) -> tuple[LeftOut, ...]:
    reasons = dict(part.left_out)
    if table.bad:
        reasons["that cannot be decoded"] = table.bad
    return LeftOut.of(f"{table.topic} message", part.total + table.bad, reasons)
