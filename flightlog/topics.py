"""Topics of a flight log: fields, units, meanings and conventions."""

from .series import Field, Topic

SCHEMA = "maneuver-flight-log/1"
"""Version of this contract, assumed for logs that name none."""

CONVENTIONS = {
    "schema": SCHEMA,
    "world": "north, east, down; metres",
    "body": "heading frame: forward along the heading, side to the right, down",
    "angles": "radians, clockwise seen along the axis; heading from north, not wrapped",
    "time": "nanoseconds since the start of the flight, simulated; log and publish time are equal",
    "viewer": "topics in /viewer_z_up: x east, y north, z up; vehicle x forward, y left, z up",
}
"""Metadata record of a log file that states its conventions."""

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
    "reference of the maneuver generator for the controller",
    (
        Field("forward", "m/s", "velocity along the heading"),
        Field("side", "m/s", "velocity to the right of the heading"),
        Field("yaw_rate", "rad/s", "rate of the heading"),
        Field("height", "m", "height above ground"),
    ),
)

MAX_INPUTS = 8
"""Commands of an imported log that are kept."""

COMMAND_INPUTS = Topic(
    COMMAND.name,
    COMMAND.message,
    COMMAND.meaning,
    (
        *COMMAND.fields,
        *(
            Field(f"input_{number}", "as logged", f"command {number} of an imported log")
            for number in range(1, MAX_INPUTS + 1)
        ),
    ),
)
"""Commands of ours, and those of imported logs, which are absent from ours."""

ESTIMATE = Topic("/estimate", "maneuver.State", "estimated state", _STATE)

TRUTH = Topic("/truth", "maneuver.State", "true state", _STATE)

NAVIGATION = Topic(
    "/navigation",
    "maneuver.Spread",
    "standard deviations of the estimate's errors, as the filter claims them",
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
    "planar motion of a vehicle without any other log",
    tuple(
        field for field in _STATE if field.name in {"north", "east", "heading", "forward", "side", "yaw_rate"}
    ),
)

WIND = Topic(
    "/wind",
    "maneuver.Wind",
    "motion of the air at the vehicle, held over a control period",
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
    "servo commands, held over a control period, and servo positions at its start",
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
        Field("to_trim", "-", "id of the trim reached; of the trim held in a coast"),
        Field("forward", "m/s", "nominal velocity of that trim"),
        Field("side", "m/s", "nominal velocity of that trim"),
        Field("yaw_rate", "rad/s", "nominal yaw rate of that trim"),
        Field("timed_out", "-", "1 if the previous primitive ended by time-out"),
    ),
)


MAX_ACTUATORS = 12
"""Controls of an imported log that are kept."""

ACTUATORS = Topic(
    "/actuators",
    "maneuver.Actuators",
    "actuators or controls of an imported log, as numbered there",
    tuple(
        Field(f"control_{number}", "as logged", f"actuator or control {number} of its autopilot")
        for number in range(1, MAX_ACTUATORS + 1)
    ),
)

FAULT = Topic(
    "/fault",
    "maneuver.Fault",
    "one message at the start and one at the end of every injected fault; absent without faults",
    (
        Field("number", "-", "place in `faults.json`, from 1"),
        Field("active", "-", "1 at its start, 0 at its end"),
        Field("size_1", "as its kind", "size, defined by the kind of fault; 0 if not used"),
        Field("size_2", "as its kind", "likewise"),
        Field("size_3", "as its kind", "likewise"),
    ),
)

FAULT_EFFECT = Topic(
    "/fault_effect",
    "maneuver.FaultEffect",
    "effect of an injected fault at every control period of it; absent without faults",
    (
        Field("number", "-", "place in `faults.json`, from 1"),
        Field("effect", "as its kind", "difference to the fault-free signal; 0 without effect"),
    ),
)

TOPICS = (
    *(COMMAND_INPUTS, ESTIMATE, TRUTH, NAVIGATION, WIND, CONTROLS, PRIMITIVE),
    *(FAULT, FAULT_EFFECT, MOTION, ACTUATORS),
)
