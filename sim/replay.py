"""Whether a log can be flown again here: its vehicle and its numeric back-end."""

from flight.errors import FlightError
from flightlog.log import FlightLog
from sim.loop.backend import Backend, best_backend, name_backend
from sim.vehicle.parameters import model_hash


class AnotherVehicleError(FlightError):
    """A log cannot be flown again here: it would be another motion."""

    def __init__(self, what: str, logged: str, here: str) -> None:
        super().__init__(f"expected the {what} of the log, {logged}, got {here}")


def refuse_another_vehicle(log: FlightLog) -> None:
    """Refuses a log of a vehicle that is not here.

    Raises:
        AnotherVehicleError: it is of another.
    """
    if log.header.model_hash != model_hash():
        raise AnotherVehicleError("vehicle", log.header.model_hash, model_hash())


def backend_named(name: str) -> Backend:
    """Returns the back-end of a log, where it is here.

    Raises:
        AnotherVehicleError: it is not.
    """
    here = {name_backend(backend): backend for backend in (Backend.INTERPRETED, best_backend())}
    if name not in here:
        raise AnotherVehicleError("numeric back-end", name, " or ".join(here))
    return here[name]
