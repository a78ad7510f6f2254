"""Replay of a logged flight from servo commands and wind."""

import json

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flightlog.attachment_names import INITIAL_STATE_ATTACHMENT, SPECIFICATION_ATTACHMENT
from flightlog.channels import CONTROLS, WIND
from flightlog.log import FlightLog
from sim.faults.vehicle_faults import vehicle_fault_schedule
from sim.loop.backend import Backend, best_backend, name_backend
from sim.loop.motion import Controls, Wind
from sim.loop.specification import CONTROL_PERIOD, parse_specification
from sim.vehicle.helicopter import Helicopter, HelicopterState
from sim.vehicle.parameters import model_hash, read_parameters


class VehicleMismatchError(FlightError):
    """Vehicle or back-end of a log that is not available here."""

    def __init__(self, what: str, logged: str, here: str) -> None:
        super().__init__(f"expected the {what} of the log, {logged}, got {here}")


def replay(log: FlightLog) -> Float[np.ndarray, "n 13"]:
    """Flies the logged servo commands in the logged wind.

    No controller or navigation runs, and no motion is prescribed. Faults of servos and vehicle are injected
    again; those of sensors and controller are in the commands, gusts in the wind.

    Returns:
        True motion at the start of every control period, columns as in `/truth`.

    Raises:
        VehicleMismatchError: vehicle or numeric back-end of the log are not available here.
        FlightLostError: the vehicle hit the ground or the motion diverged.
    """
    check_vehicle_matches(log)
    backend = backend_named(log.header.vehicle_backend)
    text = log.attachments[SPECIFICATION_ATTACHMENT]
    specification, parameters = parse_specification(text, SPECIFICATION_ATTACHMENT), read_parameters()
    step = specification.step
    helicopter = Helicopter(parameters, step=step, backend=backend)
    faults = vehicle_fault_schedule(specification.faults, helicopter, parameters)
    state = json.loads(log.attachments[INITIAL_STATE_ATTACHMENT])
    heading = state.pop("heading")
    helicopter.restore(
        HelicopterState(**{name: tuple(part) for name, part in state.items()}, heading=heading)
    )
    columns = [log[CONTROLS][f"{name}_command"] for name in Controls._fields]
    rows = []
    held = zip(np.stack(columns, axis=1).tolist(), log[WIND].values.tolist(), strict=True)
    for period, (command, wind) in enumerate(held):
        rows.append(helicopter.motion())
        faults.begin(period)
        helicopter.advance(Controls._make(command), Wind._make(wind), steps=round(CONTROL_PERIOD / step))
    return np.array(rows)


def check_vehicle_matches(log: FlightLog) -> None:
    """Refuses a log of another vehicle.

    Raises:
        VehicleMismatchError: the vehicles differ.
    """
    if log.header.model_hash != model_hash():
        raise VehicleMismatchError("vehicle", log.header.model_hash, model_hash())


def backend_named(name: str) -> Backend:
    """Returns a log's back-end by name.

    Raises:
        VehicleMismatchError: it is not available here.
    """
    here = {name_backend(backend): backend for backend in (Backend.INTERPRETED, best_backend())}
    if name not in here:
        raise VehicleMismatchError("numeric back-end", name, " or ".join(here))
    return here[name]
