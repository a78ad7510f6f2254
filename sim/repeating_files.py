"""The files that go with a flight log so that the flight can be repeated."""

import json
from dataclasses import asdict

from flight.library import Library
from flight.library_file import library_text
from flight.log import (
    INITIAL_STATE_ATTACHMENT,
    LIBRARY_ATTACHMENT,
    MODEL_ATTACHMENT,
    SPECIFICATION_ATTACHMENT,
    VEHICLE_ATTACHMENT,
)

from .helicopter import HelicopterState
from .parameters import Parameters, model_text
from .specification import FlightSpecification


def repeating_files(
    specification: FlightSpecification,
    library: Library,
    parameters: Parameters,
    initial_state: HelicopterState,
) -> dict[str, bytes]:
    """Returns what was flown, with what, by which vehicle, from which state, by the names of attachments."""
    return {
        SPECIFICATION_ATTACHMENT: specification.to_json(),
        LIBRARY_ATTACHMENT: library_text(library).encode(),
        VEHICLE_ATTACHMENT: json.dumps(asdict(parameters), indent=1).encode(),
        MODEL_ATTACHMENT: model_text(),
        INITIAL_STATE_ATTACHMENT: json.dumps(asdict(initial_state)).encode(),
    }
