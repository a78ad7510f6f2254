"""Header and input attachments of a flight's log."""

import json
from dataclasses import asdict

from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flightlog.attachment_names import (
    LIBRARY_ATTACHMENT,
    MODEL_ATTACHMENT,
    SPECIFICATION_ATTACHMENT,
    VEHICLE_ATTACHMENT,
)
from flightlog.header import FlightHeader
from runtime.code_version import code_version
from sim.loop.backend import Backend, name_backend
from sim.loop.specification import FlightSpecification
from sim.population import header_entries
from sim.vehicle.parameters import Parameters, model_hash, model_text
from sim.wind.air_statement import state_wind


def flight_header(
    specification: FlightSpecification,
    parameters: Parameters,
    *,
    backend: Backend,
    outcome: str = "completed",
) -> FlightHeader:
    """Returns the header of a flight.

    Args:
        specification: specification of the flight.
        parameters: vehicle believed.
        backend: numeric back-end.
        outcome: `completed`, or the reason of the failure.
    """
    return FlightHeader(
        kind=specification.kind,
        name=specification.name,
        vehicle=parameters.name,
        model_hash=model_hash(),
        seed=specification.seed,
        wind=specification.wind,
        code_version=code_version(),
        backend=name_backend(backend),
        outcome=outcome,
        air=state_wind(specification.wind, height=specification.altitude),
        **header_entries(specification, parameters),
    )


def flight_attachments(
    specification: FlightSpecification, library: Library, parameters: Parameters
) -> dict[str, bytes]:
    """Returns the input attachments of a flight by name."""
    return {
        SPECIFICATION_ATTACHMENT: specification.to_json(),
        LIBRARY_ATTACHMENT: library_text(library).encode(),
        VEHICLE_ATTACHMENT: json.dumps(asdict(parameters), indent=1).encode(),
        MODEL_ATTACHMENT: model_text(),
    }
