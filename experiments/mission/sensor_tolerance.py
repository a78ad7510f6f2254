"""Goal tolerances that the sensors of a flight can tell."""

from math import inf

from flight.errors import FlightError
from sim.navigation.sensor_errors import sensor_errors

from .mission_task import MissionTask

DEVIATIONS = 4.0
"""Standard deviations of the sensors that a goal's tolerance must have."""


class ToleranceTooFineError(FlightError):
    """Goal tolerance that the sensors cannot tell.

    Args:
        mission: name of the mission.
        quantity: what the tolerance is of.
        sensors: class of the sensors.
        needed: least tolerance.
        got: tolerance of the mission.
        unit: unit of both.
    """

    def __init__(
        self, mission: str, quantity: str, sensors: str, *, needed: float, got: float, unit: str
    ) -> None:
        super().__init__(
            f"mission {mission}: expected a {quantity} of at least {needed:.3g} {unit} "
            f"({DEVIATIONS:g} standard deviations of {sensors}), got {got:.3g} {unit}"
        )


def check_tolerance(task: MissionTask) -> None:
    """Checks before take-off that the sensors can tell the goal.

    Raises:
        ToleranceTooFineError: a tolerance is under four standard deviations of the sensors.
    """
    options = task.flight_options
    if task.plant != "helicopter" or options.ideal_navigation:
        return
    errors, _ = sensor_errors(options.sensors)
    mission, goal = task.mission.name, task.stated_mission.destination
    heading = goal.heading_tolerance if goal.wants_heading else inf
    for quantity, got, sigma, unit in (
        ("tolerance", goal.tolerance, errors.position_sigma, "m"),
        ("heading_tolerance", heading, errors.heading_sigma, "rad"),
    ):
        needed = DEVIATIONS * sigma
        # No tolerance at all is refused for every plant.
        if 0 < got < needed:
            raise ToleranceTooFineError(mission, quantity, options.sensors, needed=needed, got=got, unit=unit)
