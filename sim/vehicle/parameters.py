"""Vehicle parameters, read from `models/gtmax.toml` and checked."""

import hashlib
import json
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from pydantic import NonNegativeFloat, PositiveFloat

import models
from flight.file_value import FileValue, Omittable, Share
from flight.schema import check_schema_name, parse_json, refusing, toml_table

SCHEMA = "maneuver-vehicle/1"
"""Schema name of a vehicle file, assumed for files that name none."""


@dataclass(frozen=True, slots=True)
class Environment(FileValue):
    """Environment: gravity in m/s2, air density in kg/m3."""

    gravity: PositiveFloat
    air_density: PositiveFloat


@dataclass(frozen=True, slots=True)
class Body(FileValue):
    """Mass in kg and moments of inertia in kg m2, axes forward-right-down."""

    mass: PositiveFloat
    inertia_xx: PositiveFloat
    inertia_yy: PositiveFloat
    inertia_zz: PositiveFloat
    inertia_xz: float


@dataclass(frozen=True, slots=True)
class MainRotor(FileValue):
    """Main rotor: m, rad/s, hub spring in N m/rad, drag in 1/s."""

    radius: PositiveFloat
    blades: int
    chord: PositiveFloat
    lift_slope: PositiveFloat
    profile_drag: PositiveFloat
    speed: PositiveFloat
    hub_height: PositiveFloat
    hub_forward: float
    hub_spring: PositiveFloat
    flapping_time: PositiveFloat
    coupling_back_from_right: float
    coupling_right_from_back: float
    flap_back: Share
    drag_forward: PositiveFloat
    drag_side: PositiveFloat
    hub_right: Omittable[float] = 0.0


@dataclass(frozen=True, slots=True)
class StabiliserBar(FileValue):
    """Stabiliser bar: time constant in s, gains in rad/rad."""

    time: PositiveFloat
    gain_back: PositiveFloat
    gain_right: PositiveFloat
    mixing: PositiveFloat


@dataclass(frozen=True, slots=True)
class TailRotor(FileValue):
    """Tail rotor with yaw-rate gyro: m, rad/s, s."""

    radius: PositiveFloat
    blades: int
    chord: PositiveFloat
    lift_slope: PositiveFloat
    profile_drag: PositiveFloat
    speed: PositiveFloat
    arm: PositiveFloat
    height: PositiveFloat
    gyro_gain: NonNegativeFloat
    gyro_bandwidth: PositiveFloat


@dataclass(frozen=True, slots=True)
class Airframe(FileValue):
    """Flat plates and surfaces: areas in m2, arms in m."""

    plate_front: PositiveFloat
    plate_side: PositiveFloat
    plate_top: PositiveFloat
    fin_area: PositiveFloat
    fin_arm: PositiveFloat
    tailplane_area: PositiveFloat
    tailplane_arm: PositiveFloat
    surface_slope: PositiveFloat
    tailplane_wash: Share


@dataclass(frozen=True, slots=True)
class Servos(FileValue):
    """Servos: bandwidth, travel, rates, delay, rigging errors; rad and s."""

    bandwidth: PositiveFloat
    cyclic_limit: PositiveFloat
    collective_low: float
    collective_high: float
    pedal_low: float
    pedal_high: float
    rate: PositiveFloat
    pedal_rate: PositiveFloat
    delay: NonNegativeFloat
    rigging_lateral: Omittable[float] = 0.0
    rigging_longitudinal: Omittable[float] = 0.0
    rigging_collective: Omittable[float] = 0.0
    rigging_pedal: Omittable[float] = 0.0


@dataclass(frozen=True, slots=True)
class Parameters(FileValue):
    """Everything that makes one helicopter differ from another; built by `read_parameters`."""

    name: str
    environment: Environment
    body: Body
    main_rotor: MainRotor
    stabiliser_bar: StabiliserBar
    tail_rotor: TailRotor
    airframe: Airframe
    servos: Servos


def change_vehicle(
    parameters: Parameters,
    *,
    mass: float = 1.0,
    lift: float = 1.0,
    hub_forward: float = 0.0,
    extra_delay: float = 0.0,
) -> Parameters:
    """Returns a vehicle that differs from the controller's model.

    Args:
        parameters: the vehicle to change.
        mass: factor of the mass; the inertia stays.
        lift: factor of the main rotor's lift slope.
        hub_forward: by which the hub moves ahead of the centre of mass, m.
        extra_delay: added to the servos' transport delay, s.
    """
    body, rotor, servos = parameters.body, parameters.main_rotor, parameters.servos
    return replace(
        parameters,
        body=replace(body, mass=mass * body.mass),
        main_rotor=replace(
            rotor, lift_slope=lift * rotor.lift_slope, hub_forward=rotor.hub_forward + hub_forward
        ),
        servos=replace(servos, delay=servos.delay + extra_delay),
    )


def read_parameters(path: Path | None = None) -> Parameters:
    """Reads and checks the vehicle's parameters.

    Args:
        path: file in the format of `models/gtmax.toml`, the default.

    Raises:
        BadFileError: a value is missing, unknown or invalid; the message names it.
    """
    path = path or models.FOLDER / "gtmax.toml"
    content = toml_table(path)
    with refusing(path):
        check_schema_name(str(content.pop("schema", SCHEMA)), SCHEMA)
    # Read by `uncertainty` and by `sensor_errors`.
    content.pop("uncertainty", None)
    content.pop("sensors", None)
    return parse_json(json.dumps(content), path, Parameters)


def parse_parameters(text: bytes, source: str) -> Parameters:
    """Reads the vehicle's parameters from a flight log.

    Raises:
        BadFileError: a value is missing, unknown or invalid; the message names it.
    """
    return parse_json(text, source, Parameters)


@cache
def model_hash() -> str:
    """Returns the SHA-256 of the vehicle's parameters and shape."""
    files = (models.FOLDER / name for name in ("gtmax.toml", "gtmax.xml"))
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()


def model_text() -> bytes:
    """Returns the vehicle's shape as MJCF."""
    return (models.FOLDER / "gtmax.xml").read_bytes()
