"""Checks that a log can be flown again here."""

from flight.errors import FlightError
from flightlog.log import FlightLog
from sim.loop.backend import Backend, best_backend, name_backend
from sim.loop.specification import FlightSpecification
from sim.vehicle.parameters import model_hash
from sim.wind.air_statement import STILL_AIR, state_wind


class VehicleMismatchError(FlightError):
    """Vehicle, air or back-end of a log that is not available here."""

    def __init__(self, what: str, logged: str, here: str) -> None:
        super().__init__(f"expected the {what} of the log, {logged}, got {here}: it cannot be repeated here")


def check_vehicle_matches(log: FlightLog) -> None:
    """Refuses a log of another vehicle.

    Raises:
        VehicleMismatchError: the vehicles differ.
    """
    if log.header.model_hash != model_hash():
        raise VehicleMismatchError("vehicle", log.header.model_hash, model_hash())


def check_air_matches(log: FlightLog, specification: FlightSpecification) -> None:
    """Refuses a log flown in other air of the same name.

    Raises:
        VehicleMismatchError: the air differs, or the log states none.
    """
    here = state_wind(specification.wind, height=specification.altitude)
    # Logs of earlier releases do not state the air; still air was the same.
    earlier = "" if here == STILL_AIR and not specification.wind_changes else here
    if log.header.air not in {here, earlier}:
        raise VehicleMismatchError("air", log.header.air or "not stated", here)


def backend_named(name: str) -> Backend:
    """Returns a log's back-end by name.

    Raises:
        VehicleMismatchError: it is not available here.
    """
    here = {name_backend(backend): backend for backend in (Backend.INTERPRETED, best_backend())}
    if name not in here:
        raise VehicleMismatchError("numeric back-end", name, " or ".join(here))
    return here[name]
