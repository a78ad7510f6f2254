"""Controls of a vehicle whose rotors and surfaces are not the helicopter's: numbered, as they were logged."""

from .series import Field, Topic

MOST_ACTUATORS = 12

ACTUATORS = Topic(
    "/actuators",
    "maneuver.Actuators",
    "controls of a vehicle of another kind; only those that its log has",
    tuple(
        Field(f"control_{number}", "as logged", f"actuator or control {number} of its autopilot")
        for number in range(1, MOST_ACTUATORS + 1)
    ),
)
