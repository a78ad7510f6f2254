"""The channels of the flight log that tell of faults."""

from .series import Field, Topic

FAULT = Topic(
    "/fault",
    "maneuver.Fault",
    "one message at the start and one at the end of every fault; absent where none was asked for",
    (
        Field("number", "-", "place in `faults.json`, from 1"),
        Field("active", "-", "1 where it starts, 0 where it ends"),
        Field("size_1", "as its kind", "by how much, as the kind of fault counts it; 0 where it does not"),
        Field("size_2", "as its kind", "likewise"),
        Field("size_3", "as its kind", "likewise"),
    ),
)
FAULT_EFFECT = Topic(
    "/fault_effect",
    "maneuver.FaultEffect",
    "what shows that a fault acted, for every control period of its; absent where none was asked for",
    (
        Field("number", "-", "place in `faults.json`, from 1"),
        Field("effect", "as its kind", "how far it takes the flight from one without it; 0 where not at all"),
    ),
)
