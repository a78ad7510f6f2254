"""Vehicle and sensors that a flight draws, by its specification."""

from sim.loop.specification import CONTROL_PERIOD, FlightSpecification
from sim.loop.streams import Stream, random_stream
from sim.navigation.installation import Installation, draw_installation
from sim.navigation.sensor_errors import SensorErrors, sensor_errors
from sim.vehicle.parameters import Parameters
from sim.vehicle.uncertainty import DrawnVehicle, draw_vehicle, shipped_uncertainty

IDEAL = "ideal"
"""Name of sensors without errors in a header."""


def vehicle_of(specification: FlightSpecification, nominal: Parameters) -> DrawnVehicle:
    """Returns the vehicle that a specified flight flies.

    `nominal` is exact; of `one`, the airframe is that of the airframe seed; of a `fleet`, that of the flight.
    """
    if specification.vehicles == "nominal":
        return DrawnVehicle(nominal)
    return draw_vehicle(
        nominal,
        shipped_uncertainty(),
        airframe=random_stream(_airframe_seed(specification), Stream.AIRFRAME),
        flight=random_stream(specification.seed, Stream.LOADING),
    )


def sensors_of(
    specification: FlightSpecification, vehicle: DrawnVehicle
) -> tuple[SensorErrors, SensorErrors, Installation]:
    """Returns the errors believed, the errors made, and the installation.

    Raises:
        UnknownSensorsError: the class does not exist.
    """
    believed, made = sensor_errors(specification.sensors)
    rotor = vehicle.parameters.main_rotor
    installation = draw_installation(
        made,
        random_stream(_airframe_seed(specification), Stream.INSTALLATION),
        step=CONTROL_PERIOD,
        blade_frequency=rotor.blades * rotor.speed,
        centre_of_mass=vehicle.centre_of_mass,
    )
    return believed, made, installation


def header_entries(specification: FlightSpecification, nominal: Parameters) -> dict[str, str]:
    """Returns the entries of a flight's header that say what it draws."""
    return {
        "vehicles": specification.flight_options.population,
        "drawn": vehicle_of(specification, nominal).describe(),
        "sensors": IDEAL if specification.ideal_navigation else specification.sensors,
    }


def _airframe_seed(specification: FlightSpecification) -> int:
    if specification.vehicles == "one" and specification.airframe_seed is not None:
        return specification.airframe_seed
    return specification.seed
