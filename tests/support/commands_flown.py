"""A logged flight flown again from its servo commands and wind: no force is prescribed motion."""

import json

import numpy as np
from jaxtyping import Float

from flightlog.attachment_names import INITIAL_STATE_ATTACHMENT, SPECIFICATION_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.topics import CONTROLS, WIND
from sim.faults.vehicle_faults import vehicle_fault_schedule
from sim.loop.motion import Controls, Wind
from sim.loop.specification import CONTROL_PERIOD, parse_specification
from sim.replay import backend_named, check_vehicle_matches
from sim.vehicle.helicopter import Helicopter, HelicopterState
from sim.vehicle.parameters import read_parameters


def replay(log: FlightLog) -> Float[np.ndarray, "n 13"]:
    """Flies the logged servo commands in the logged wind, without controller or navigation.

    Faults of servos and vehicle act again; those of sensors and controller are in the commands, gusts in the
    wind.

    Returns:
        True motion at the start of every control period, columns as in `/truth`.

    Raises:
        AnotherVehicleError: the log is of another vehicle or numeric back-end than is here.
        FlightLostError: the flight ended in the ground or diverged.
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
