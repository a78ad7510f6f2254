"""Options of `maneuver import`, and those that each kind of file has."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from flight.errors import FlightError
from flightlog.imports.axes import BodyAxes, WorldAxes
from flightlog.imports.bags.ros_bag import RosBag
from flightlog.imports.clock import TimeUnit
from flightlog.imports.csv_log import read_external_csv
from flightlog.imports.dataflash_log import read_dataflash_log
from flightlog.imports.kinds import Kind, kind_of
from flightlog.imports.mcap_log import McapImportSettings, read_external_mcap
from flightlog.imports.motion.frames import Frames, QuaternionOrder, VelocityAxes
from flightlog.imports.motion.units import AngleUnit, LengthUnit, Quantity, RateUnit, SpeedUnit
from flightlog.imports.px4_log import read_px4_log
from flightlog.imports.tables.table import TableSettings
from flightlog.log import FlightLog
from flightlog.series import Topic
from flightlog.topics import ESTIMATE, TRUTH

_Words = Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")]

_BAGS = ("pose", "velocity", "quaternion_order", "child_frame", "frames")
_TABLES = (
    *("columns", "time_unit", "length_unit", "speed_unit", "angle_unit", "rate_unit"),
    *("rate", "vehicle_id"),
)
_AXES = ("world", "body", "velocity_in", "as_", "unchecked")
ACCEPTED: Mapping[Kind, tuple[str, ...]] = {
    "ULog": ("part",),
    "DataFlash log": ("part",),
    "MCAP": (*_BAGS, *_AXES, "part"),
    "ROS 1 bag": (*_BAGS, *_AXES, "part"),
    "ROS 2 bag": (*_BAGS, *_AXES, "part"),
    "table": (*_TABLES, *_AXES, "part", "command"),
}
"""Options of each kind of file."""

_KINDS: Mapping[Kind, str] = {
    **{"ULog": "a .ulg file", "DataFlash log": "a .bin file", "MCAP": "an .mcap file"},
    **{"ROS 1 bag": "a .bag file", "ROS 2 bag": "a ROS 2 bag", "table": "a table"},
}


@Parameter(name="*")
@dataclass(frozen=True, slots=True)
class ImportOptions:
    """Facts that a log leaves open.

    Attributes:
        pose: topic of an MCAP file or a bag with position and attitude.
        velocity: topic with the velocity; the pose topic by default.
        frames: frame and child frame of transforms (TFMessage), as /tf holds them.
        child_frame: vehicle of a topic of several, by its child frame.
        columns: of a table, as NAME=HEADING, or NAME=#N for the column of number N.
        time_unit: of a table's times; seconds by default, where that is certain.
        length_unit: of a table's positions and heights; metres by default.
        speed_unit: of a table's velocities; m/s by default.
        angle_unit: of a table's angles; radians by default.
        rate_unit: of a table's body rates; rad/s by default.
        rate: of a table whose rows are at equal intervals, in Hz; in place of its times.
        vehicle_id: vehicle of a table of several, as the column id has it.
        command: columns of a table that hold commands, by their headings.
        part: number of the part, where the clock was set back or jumps.
        world: axes of the world: north, east, down or east, north, up.
        body: axes of the body: forward, right, down or forward, left, up.
        velocity_in: axes of the velocities: world or body.
        quaternion_order: of quaternions that are lists without names.
        as_: meaning of the log: the vehicle's estimate (the default), or the truth, such as from a
            motion-capture system.
        unchecked: import numbers that contradict one another.
    """

    pose: str | None = None
    velocity: str | None = None
    frames: tuple[str, str] | None = None
    child_frame: str | None = None
    columns: _Words = ()
    time_unit: TimeUnit | None = None
    length_unit: LengthUnit | None = None
    speed_unit: SpeedUnit | None = None
    angle_unit: AngleUnit | None = None
    rate_unit: RateUnit | None = None
    rate: float | None = None
    vehicle_id: str | None = None
    command: _Words = ()
    part: int | None = None
    world: WorldAxes | None = None
    body: BodyAxes | None = None
    velocity_in: VelocityAxes | None = None
    quaternion_order: QuaternionOrder | None = None
    as_: Annotated[Literal["estimate", "truth"] | None, Parameter(name="--as")] = None
    unchecked: Annotated[bool, Parameter(negative="")] = False

    @property
    def topic(self) -> Topic:
        """Topic of the motion: estimate or truth."""
        return TRUTH if self.as_ == "truth" else ESTIMATE

    def check(self, kind: Kind) -> None:
        """Refuses options that a kind of file has no use for.

        Raises:
            FlightError: there is one; the message names those that it has.
        """
        given = [field.name for field in fields(self) if getattr(self, field.name)]
        wrong = [name for name in given if name not in ACCEPTED[kind]]
        if wrong:
            raise FlightError(
                f"{', '.join(map(_option, wrong))}: not valid for {_KINDS[kind]}; its options are "
                f"{', '.join(map(_option, ACCEPTED[kind]))}"
            )
        if self.rate is not None and not 0.0 < self.rate < 1e5:
            raise FlightError(f"--rate: expected a rate above 0 and below 100000 Hz, got {self.rate:g}")

    def for_table(self) -> TableSettings:
        """Returns the choices for a table."""
        units: dict[Quantity, str | None] = {
            **{"time": self.time_unit, "length": self.length_unit, "speed": self.speed_unit},
            **{"angle": self.angle_unit, "rate": self.rate_unit},
        }
        return TableSettings(
            columns=_pairs(self.columns),
            commands=self.command,
            frames=Frames(self.world or "ned", self.body or "frd", self.velocity_in or "world"),
            units={quantity: unit for quantity, unit in units.items() if unit},
            rate=self.rate,
            part=self.part,
            vehicle=self.vehicle_id,
            unchecked=self.unchecked,
        )

    def for_bag(self) -> McapImportSettings:
        """Returns the choices for an MCAP or a ROS bag.

        Raises:
            FlightError: no topic is chosen.
        """
        return McapImportSettings(
            pose=self.pose,
            velocity=self.velocity,
            world=self.world,
            body=self.body,
            velocity_in=self.velocity_in,
            quaternion=self.quaternion_order,
            child_frame=self.child_frame,
            frames=self.frames,
            part=self.part,
            unchecked=self.unchecked,
        )


def _option(name: str) -> str:
    return f"--{name.rstrip('_').replace('_', '-')}"


def _pairs(columns: tuple[str, ...]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for words in columns:
        name, sign, heading = words.partition("=")
        if not (name and sign and heading):
            raise FlightError(f"--columns: expected NAME=HEADING, got {words!r}")
        if name in pairs:
            raise FlightError(f"--columns: {name} is given twice, as {pairs[name]!r} and {heading!r}")
        pairs[name] = heading
    return pairs


def read_flight(log: Path, options: ImportOptions) -> FlightLog:
    """Reads a log of another program.

    Raises:
        FlightError: it is no such log, or leaves a choice open.
    """
    kind = kind_of(log)
    options.check(kind)
    if kind == "ULog":
        return read_px4_log(log, part=options.part)
    if kind == "DataFlash log":
        return read_dataflash_log(log, part=options.part)
    if kind == "table":
        return read_external_csv(log, options.for_table(), topic=options.topic)
    bag = None if kind == "MCAP" else RosBag(log)
    return read_external_mcap(log, options.for_bag(), topic=options.topic, bag=bag)
