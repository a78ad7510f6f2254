"""Vehicle faults: jammed, slow or lagging servos, changed mass or lift."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from flight.mission.fault import SERVOS, Fault
from sim.vehicle.helicopter import Helicopter
from sim.vehicle.parameters import Parameters, change_vehicle
from sim.vehicle.rotor_step import ServoDynamics, nominal_servo_dynamics

from .fault_schedule import FaultSchedule


class FaultyVehicle:
    """Helicopter whose parameters change with its faults.

    Args:
        helicopter: helicopter flown.
        parameters: vehicle without faults.
    """

    def __init__(self, helicopter: Helicopter, parameters: Parameters) -> None:
        self._helicopter, self._sound = helicopter, parameters
        self._faults: dict[int, Fault] = {}

    def begin(self, number: int, fault: Fault) -> Callable[[], float]:
        """Starts a fault at the next plant step; returns its effect function."""
        self._faults[number] = fault
        self._refit()
        if fault.where in SERVOS:
            servo = SERVOS.index(fault.where)
            return lambda: float(self._helicopter.lacking[servo])
        factor = fault.size[0]
        change = (factor - 1.0) * self._sound.body.mass if fault.what == "mass" else factor - 1.0
        return lambda: change

    def end(self, number: int, fault: Fault) -> None:
        """Ends a fault."""
        del self._faults[number]
        self._refit()

    def _refit(self) -> None:
        """Applies the parameters under all active faults."""
        vehicle, servo_dynamics = self._sound, list(nominal_servo_dynamics(self._sound.servos))
        for fault in self._faults.values():
            if fault.where in SERVOS:
                servo = SERVOS.index(fault.where)
                servo_dynamics[servo] = _faulty_servo(servo_dynamics[servo], fault)
            else:
                vehicle = change_vehicle(vehicle, **{fault.what: fault.size[0]})
        lateral, longitudinal, collective, pedal = servo_dynamics
        self._helicopter.refit(vehicle, (lateral, longitudinal, collective, pedal))


def vehicle_fault_schedule(
    faults: Sequence[Fault], helicopter: Helicopter, parameters: Parameters
) -> FaultSchedule:
    """Returns the schedule of servo, mass and lift faults."""
    vehicle = FaultyVehicle(helicopter, parameters)
    own = {number: fault for number, fault in enumerate(faults) if fault.where in (*SERVOS, "vehicle")}
    return FaultSchedule(own, dict.fromkeys((*SERVOS, "vehicle"), vehicle))


def _faulty_servo(drive: ServoDynamics, fault: Fault) -> ServoDynamics:
    match fault.what:
        case "jam":
            return replace(drive, rate=0.0)
        case "slow":
            return replace(drive, rate=fault.size[0] * drive.rate)
        case _:
            return replace(drive, bandwidth=min(drive.bandwidth, 1.0 / fault.size[0]))
