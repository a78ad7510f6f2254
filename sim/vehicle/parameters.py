"""The numbers of the vehicle, read once from `models/gtmax.toml` and checked there."""

import hashlib
import json
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Annotated, ClassVar

from pydantic import ConfigDict, Field, TypeAdapter, ValidationError

import models
from flight.errors import BadFileError
from flight.schema import check_schema_name, first_problem, read_text

SCHEMA = "maneuver-vehicle/1"
"""What a vehicle's file may name itself; one that does not is of this version."""

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Finite = Annotated[float, Field(allow_inf_nan=False)]

_STRICT = ConfigDict(extra="forbid", strict=True)


@dataclass(frozen=True, slots=True)
class Environment:
    """What surrounds the vehicle: gravity in m/s2, air density in kg/m3."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    gravity: Positive
    air_density: Positive


@dataclass(frozen=True, slots=True)
class Body:
    """Mass in kg and moments of inertia in kg m2 about the centre of mass, axes forward-right-down."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    mass: Positive
    inertia_xx: Positive
    inertia_yy: Positive
    inertia_zz: Positive
    inertia_xz: Finite


@dataclass(frozen=True, slots=True)
class MainRotor:
    """The lifting rotor: lengths in m, speed in rad/s, hub spring in N m/rad, drag shares in 1/s."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    radius: Positive
    blades: int
    chord: Positive
    lift_slope: Positive
    profile_drag: Positive
    speed: Positive
    hub_height: Positive
    hub_forward: Finite
    hub_spring: Positive
    flapping_time: Positive
    coupling_back_from_right: Finite
    coupling_right_from_back: Finite
    flap_back: Share
    drag_forward: Positive
    drag_side: Positive


@dataclass(frozen=True, slots=True)
class StabiliserBar:
    """The bar that damps body rates: time in s, gains in rad per rad."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    time: Positive
    gain_back: Positive
    gain_right: Positive
    mixing: Positive


@dataclass(frozen=True, slots=True)
class TailRotor:
    """The rotor that holds the heading: lengths in m, speed in rad/s; its yaw-rate gyro in s and rad/s."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    radius: Positive
    blades: int
    chord: Positive
    lift_slope: Positive
    profile_drag: Positive
    speed: Positive
    arm: Positive
    height: Positive
    gyro_gain: Annotated[float, Field(ge=0.0)]
    gyro_bandwidth: Positive


@dataclass(frozen=True, slots=True)
class Airframe:
    """Flat plates and surfaces: areas in m2, arms behind the centre of mass in m."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    plate_front: Positive
    plate_side: Positive
    plate_top: Positive
    fin_area: Positive
    fin_arm: Positive
    tailplane_area: Positive
    tailplane_arm: Positive
    surface_slope: Positive
    tailplane_wash: Share


@dataclass(frozen=True, slots=True)
class Servos:
    """Servo bandwidth in rad/s, travel in rad of blade pitch, rates in rad/s, transport delay in s."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    bandwidth: Positive
    cyclic_limit: Positive
    collective_low: Finite
    collective_high: Finite
    pedal_low: Finite
    pedal_high: Finite
    rate: Positive
    pedal_rate: Positive
    delay: Annotated[float, Field(ge=0.0)]


@dataclass(frozen=True, slots=True)
class Parameters:
    """Everything that makes one helicopter differ from another; built by `read_parameters`."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
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
    """Returns a vehicle that is not the one its controller was made for.

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
    """Reads and checks the vehicle's numbers.

    Args:
        path: a file in the form of `models/gtmax.toml`, which is the default.

    Raises:
        BadFileError: a value is missing, unknown or impossible; the message names it.
    """
    path = path or models.FOLDER / "gtmax.toml"
    try:
        content = tomllib.loads(read_text(path))
        check_schema_name(str(content.pop("schema", SCHEMA)), SCHEMA)
        # A strict model takes a table for a dataclass only from JSON.
        return _reader().validate_json(json.dumps(content))
    except tomllib.TOMLDecodeError as error:
        raise BadFileError(path, f"is not TOML: {error}") from None
    except ValidationError as error:
        raise BadFileError(path, first_problem(error)) from None
    except (ValueError, TypeError) as error:
        raise BadFileError(path, str(error)) from None


def parse_parameters(text: bytes, source: str) -> Parameters:
    """Reads the vehicle's numbers back from a flight log.

    Raises:
        BadFileError: a value is missing, unknown or impossible; the message names it.
    """
    try:
        return _reader().validate_json(text)
    except ValidationError as error:
        raise BadFileError(source, first_problem(error)) from None


@cache
def _reader() -> TypeAdapter[Parameters]:
    return TypeAdapter(Parameters)


@cache
def model_hash() -> str:
    """Returns the SHA-256 of the vehicle's numbers and shape, in hexadecimal."""
    files = (models.FOLDER / name for name in ("gtmax.toml", "gtmax.xml"))
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()


def model_text() -> bytes:
    """Returns the vehicle's shape as MJCF."""
    return (models.FOLDER / "gtmax.xml").read_bytes()
