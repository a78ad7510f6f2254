"""The flight log: what was commanded, believed and true, on one time axis.

This module is the contract of the channels that programs read: topics, fields, units, frames; those that
viewers draw are made from them by `flight.viewer_channels`, and never read back. World axes are north, east,
down. Velocities are given in the heading frame, the level body frame: forward along the heading, side to the
right, down. Angles are clockwise seen along the axis; headings are not wrapped. Times are seconds since the
flight's start.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

from .actuator_topic import ACTUATORS as ACTUATORS
from .errors import FlightError
from .fault_topics import FAULT as FAULT
from .fault_topics import FAULT_EFFECT as FAULT_EFFECT
from .header import FlightHeader as FlightHeader
from .library import Library
from .library_file import parse_library
from .se2 import Twist
from .series import Field as Field
from .series import Series as Series
from .series import Topic as Topic

LIBRARY_ATTACHMENT = "library.json"
"""The library flown with: names what `/primitive` counts, and carries the maneuver-end rule."""

INITIAL_STATE_ATTACHMENT = "initial_state.json"
"""The vehicle's true state at time 0; with controls and wind it reproduces the true motion."""

SPECIFICATION_ATTACHMENT = "specification.json"
"""All that the simulator needs to repeat the flight."""

FAULTS_ATTACHMENT = "faults.json"
"""What goes wrong in the flight, by numbers from 1: a JSON array of `flight.fault.Fault`; absent in most."""

PLANS_ATTACHMENT = "plans.json"
"""The plans of a flight in receding horizon, in order: a JSON array of `maneuver-plan/1` with their times."""

MISSION_ATTACHMENT = "mission.json"
"""The mission of a flight in receding horizon."""

VEHICLE_ATTACHMENT = "vehicle.json"
"""Every number of the vehicle that flew, with the changes that were made to it."""

IMPORT_ATTACHMENT = "import.json"
"""Where a log that another program wrote came from: its file, its SHA-256, what it says of itself."""

MODEL_ATTACHMENT = "model.xml"
"""The vehicle's shape, as MuJoCo's MJCF: x forward, y left, z up."""

SCHEMA = "maneuver-flight-log/1"
"""Version of this contract; a log that names none is of this one."""

CONVENTIONS = {
    "schema": SCHEMA,
    "world": "north, east, down; metres",
    "body": "heading frame: forward along the heading, side to the right, down",
    "angles": "radians, clockwise seen along the axis; heading from north, not wrapped",
    "time": "nanoseconds since the start of the flight, simulated; log and publish time are equal",
    "viewer": "topics in /viewer_z_up: x east, y north, z up; vehicle x forward, y left, z up",
}
"""What a metadata record of this name says, for who has the file alone."""


_STATE = (
    Field("north", "m", "position in the world"),
    Field("east", "m", "position in the world"),
    Field("down", "m", "position in the world; minus the height above ground"),
    Field("forward", "m/s", "velocity along the heading, horizontal"),
    Field("side", "m/s", "velocity to the right of the heading, horizontal"),
    Field("descent", "m/s", "velocity down"),
    Field("roll", "rad", "right side down positive"),
    Field("pitch", "rad", "nose up positive"),
    Field("heading", "rad", "clockwise from north, not wrapped"),
    Field("roll_rate", "rad/s", "about the body's forward axis"),
    Field("pitch_rate", "rad/s", "about the body's right axis"),
    Field("body_yaw_rate", "rad/s", "about the body's down axis"),
    Field("yaw_rate", "rad/s", "rate of the heading"),
)

COMMAND = Topic(
    "/command",
    "maneuver.Command",
    "what the maneuver generator asks of the controller",
    (
        Field("forward", "m/s", "velocity along the heading"),
        Field("side", "m/s", "velocity to the right of the heading"),
        Field("yaw_rate", "rad/s", "rate of the heading"),
        Field("height", "m", "height above ground"),
    ),
)
ESTIMATE = Topic("/estimate", "maneuver.State", "what the vehicle believes", _STATE)
TRUTH = Topic("/truth", "maneuver.State", "what is so", _STATE)
NAVIGATION = Topic(
    "/navigation",
    "maneuver.Spread",
    "what the vehicle believes of the estimate's errors: one standard deviation of each",
    (
        Field("north", "m", "position in the world"),
        Field("east", "m", "position in the world"),
        Field("down", "m", "position in the world"),
        Field("forward", "m/s", "velocity along the heading, horizontal"),
        Field("side", "m/s", "velocity to the right of the heading, horizontal"),
        Field("descent", "m/s", "velocity down"),
        Field("roll", "rad", "roll angle"),
        Field("pitch", "rad", "pitch angle"),
        Field("heading", "rad", "heading"),
    ),
)
MOTION = Topic(
    "/motion",
    "maneuver.PlanarMotion",
    "what is known of the motion of a vehicle that keeps no other log",
    tuple(
        field for field in _STATE if field.name in {"north", "east", "heading", "forward", "side", "yaw_rate"}
    ),
)
WIND = Topic(
    "/wind",
    "maneuver.Wind",
    "the air's motion at the vehicle, held over a control period",
    (
        Field("north", "m/s", "velocity of the air over the ground, mean wind and gust"),
        Field("east", "m/s", "velocity of the air over the ground, mean wind and gust"),
        Field("down", "m/s", "velocity of the air over the ground, mean wind and gust"),
        Field("rate_north", "rad/s", "rotation of the air about the north axis"),
        Field("rate_east", "rad/s", "rotation of the air about the east axis"),
        Field("rate_down", "rad/s", "rotation of the air about the down axis"),
    ),
)
CONTROLS = Topic(
    "/controls",
    "maneuver.Controls",
    "servo commands, held over a control period, and where the servos are when they are given",
    (
        Field("collective_command", "rad", "main rotor collective pitch"),
        Field("longitudinal_command", "rad", "longitudinal cyclic pitch, nose up positive"),
        Field("lateral_command", "rad", "lateral cyclic pitch, right positive"),
        Field("pedal_command", "rad", "tail rotor collective pitch"),
        Field("collective", "rad", "main rotor collective pitch"),
        Field("longitudinal", "rad", "longitudinal cyclic pitch, nose up positive"),
        Field("lateral", "rad", "lateral cyclic pitch, right positive"),
        Field("pedal", "rad", "tail rotor collective pitch"),
    ),
)
PRIMITIVE = Topic(
    "/primitive",
    "maneuver.Primitive",
    "one message at the start of every coast and every maneuver",
    (
        Field("kind", "-", "0 coast, 1 maneuver"),
        Field("id", "-", "id of the trim held, or of the maneuver"),
        Field("from_trim", "-", "id of the trim left; of the trim held in a coast"),
        Field("to_trim", "-", "id of the trim led to; of the trim held in a coast"),
        Field("forward", "m/s", "nominal velocity of that trim"),
        Field("side", "m/s", "nominal velocity of that trim"),
        Field("yaw_rate", "rad/s", "nominal yaw rate of that trim"),
        Field("timed_out", "-", "1 where the primitive before ended by time-out"),
    ),
)

TOPICS = (
    *(COMMAND, ESTIMATE, TRUTH, NAVIGATION, WIND, CONTROLS, PRIMITIVE),
    *(FAULT, FAULT_EFFECT, MOTION, ACTUATORS),
)


class PrimitiveKind(IntEnum):
    """Values of `/primitive` `kind`."""

    COAST = 0
    MANEUVER = 1


class MissingTopicError(FlightError):
    """A log lacks a topic that is needed; absent is not zero."""

    def __init__(self, topic: Topic, present: Mapping[str, object]) -> None:
        super().__init__(f"the log has no {topic.name}; it has {sorted(present)}")


@dataclass(frozen=True, slots=True, eq=False)
class FlightLog:
    """One flight: header, series by topic name, attachments by file name."""

    header: FlightHeader
    series: Mapping[str, Series]
    attachments: Mapping[str, bytes]

    def __getitem__(self, topic: Topic) -> Series:
        """Returns the series of a topic.

        Raises:
            MissingTopicError: the log has none.
        """
        try:
            return self.series[topic.name]
        except KeyError:
            raise MissingTopicError(topic, self.series) from None

    @property
    def motion(self) -> Series:
        """The true motion; where it is not known, what was believed of it, or what else there is."""
        known = (topic for topic in (TRUTH, ESTIMATE, MOTION) if topic.name in self.series)
        return self[next(known, TRUTH)]

    @property
    def duration(self) -> float:
        """Seconds from the start to the last state."""
        return float(self.motion.time[-1])

    def library(self) -> Library:
        """Returns the library flown with.

        Raises:
            FlightError: the log carries none, or a broken one.
        """
        try:
            text = self.attachments[LIBRARY_ATTACHMENT]
        except KeyError:
            raise FlightError(
                f"the log has no {LIBRARY_ATTACHMENT}; it has {sorted(self.attachments)}"
            ) from None
        return parse_library(text, LIBRARY_ATTACHMENT)


@dataclass(frozen=True, slots=True)
class PrimitiveFlown:
    """One row of `/primitive` as a value.

    Attributes:
        kind: coast or maneuver.
        id: id of the trim held, or of the maneuver.
        from_trim: id of the trim left; of the trim held in a coast.
        to_trim: id of the trim led to; of the trim held in a coast.
        target: nominal velocity of that trim.
        start: seconds.
        end: seconds; the start of the next primitive, or the end of the log.
        timed_out: whether the executor ended it by time-out.
    """

    kind: PrimitiveKind
    id: int
    from_trim: int
    to_trim: int
    target: Twist
    start: float
    end: float
    timed_out: bool


def primitives_flown(log: FlightLog) -> tuple[PrimitiveFlown, ...]:
    """Returns the primitives of a log in the order flown."""
    series = log[PRIMITIVE]
    ends = [*series.time[1:].tolist(), log.duration]
    timed_out = [*series["timed_out"][1:].tolist(), 0.0]
    return tuple(
        PrimitiveFlown(
            kind=PrimitiveKind(int(row[0])),
            id=int(row[1]),
            from_trim=int(row[2]),
            to_trim=int(row[3]),
            target=Twist(row[4], row[5], row[6]),
            start=start,
            end=end,
            timed_out=bool(late),
        )
        for row, start, end, late in zip(
            series.values.tolist(), series.time.tolist(), ends, timed_out, strict=True
        )
    )
