"""Vehicle parameters, read from `models/gtmax.toml` and checked."""

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
"""Schema name of a vehicle file, assumed for files that name none."""

Positive = Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0.0, le=1.0)]
Finite = Annotated[float, Field(allow_inf_nan=False)]

_STRICT = ConfigDict(extra="forbid", strict=True)


@dataclass(frozen=True, slots=True)
class Environment:
    """Environment: gravity in m/s2, air density in kg/m3."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    gravity: Positive
    air_density: Positive


@dataclass(frozen=True, slots=True)
class Body:
    """Mass in kg and moments of inertia in kg m2.

    About the centre of mass, axes forward-right-down.
    """

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    mass: Positive
    inertia_xx: Positive
    inertia_yy: Positive
    inertia_zz: Positive
    inertia_xz: Finite


@dataclass(frozen=True, slots=True)
class MainRotor:
    """Main rotor.

    Lengths in m, speed in rad/s, hub spring in N m/rad, drag shares in 1/s.
    """

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
    """Stabiliser bar: time constant in s, gains in rad/rad."""

    __pydantic_config__: ClassVar[ConfigDict] = _STRICT
    time: Positive
    gain_back: Positive
    gain_right: Positive
    mixing: Positive


@dataclass(frozen=True, slots=True)
class TailRotor:
    """Tail rotor and yaw-rate gyro.

    Lengths in m, speed in rad/s; gyro gain in s and bandwidth in rad/s.
    """

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
    """Flat plates and surfaces: areas in m2, arms in m.

    Arms are measured backwards from the centre of mass.
    """

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
    """Servos: bandwidth and rates in rad/s, travel in rad, delay in s.

    Travel and rates are those of the blade pitch.
    """

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
    """Parameters of a helicopter, built by `read_parameters`."""

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
    try:
        content = tomllib.loads(read_text(path))
        check_schema_name(str(content.pop("schema", SCHEMA)), SCHEMA)
        # A strict model accepts a table as a dataclass only from JSON.
        return _reader().validate_json(json.dumps(content))
    except tomllib.TOMLDecodeError as error:
        raise BadFileError(path, f"is not TOML: {error}") from None
    except ValidationError as error:
        raise BadFileError(path, first_problem(error)) from None
    except (ValueError, TypeError) as error:
        raise BadFileError(path, str(error)) from None


def parse_parameters(text: bytes, source: str) -> Parameters:
    """Reads the vehicle's parameters from a flight log.

    Raises:
        BadFileError: a value is missing, unknown or invalid; the message names it.
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
    """Returns the SHA-256 of the vehicle's parameters and shape."""
    files = (models.FOLDER / name for name in ("gtmax.toml", "gtmax.xml"))
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()


def model_text() -> bytes:
    """Returns the vehicle's shape as MJCF."""
    return (models.FOLDER / "gtmax.xml").read_bytes()
