"""Vehicles drawn around the nominal one, within what is unknown."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import PositiveFloat

import models
from flight.file_value import FileValue
from flight.schema import parse_json, refusing, toml_table

from .parameters import Parameters

CENTRE_OF_MASS = ("centre_of_mass.forward", "centre_of_mass.right", "centre_of_mass.down")
"""Quantities of the uncertainty that are no parameters: shifts from the nominal place, m."""

LARGEST = 2.5
"""Standard deviations beyond which a draw is repeated: acceptance tests find what is farther off."""

INERTIA = ("body.inertia_xx", "body.inertia_yy", "body.inertia_zz", "body.inertia_xz")
"""Parameters of the body in MuJoCo; no load depends on them."""

VARIED = (
    "body.mass",
    *(
        f"main_rotor.{name}"
        for name in (
            *("lift_slope", "hub_height", "hub_forward", "hub_right", "hub_spring", "flapping_time"),
            *("coupling_back_from_right", "coupling_right_from_back", "flap_back"),
            *("drag_forward", "drag_side"),
        )
    ),
    *(f"stabiliser_bar.{name}" for name in ("gain_back", "gain_right")),
    *(f"tail_rotor.{name}" for name in ("lift_slope", "arm", "height", "gyro_gain")),
    *(
        f"airframe.{name}"
        for name in (
            *("plate_front", "plate_side", "plate_top", "fin_area", "fin_arm"),
            *("tailplane_area", "tailplane_arm"),
        )
    ),
    *(
        f"servos.{name}"
        for name in (
            *("bandwidth", "rigging_lateral", "rigging_longitudinal"),
            *("rigging_collective", "rigging_pedal"),
        )
    ),
)
"""Parameters in the loads that may differ from flight to flight, in the order of the plant's input."""

DELAY = "servos.delay"
_KNOWN = frozenset((*CENTRE_OF_MASS, *INERTIA, *VARIED, DELAY))


@dataclass(frozen=True)
class UncertaintyLevel(FileValue):
    """Standard deviations by parameter.

    Attributes:
        share: of the nominal value.
        size: in the parameter's unit.
    """

    share: Mapping[str, PositiveFloat]
    size: Mapping[str, PositiveFloat]

    def __post_init__(self) -> None:
        """Refuses parameters that are not drawn."""
        unknown = sorted({*self.share, *self.size} - _KNOWN)
        if unknown:
            raise ValueError(f"no parameter {unknown[0]!r} is drawn; there are {sorted(_KNOWN)}")


@dataclass(frozen=True)
class VehicleUncertainty(FileValue):
    """VehicleUncertainty between airframes, and between flights of one airframe."""

    airframe: UncertaintyLevel
    flight: UncertaintyLevel


@dataclass(frozen=True, slots=True)
class DrawnVehicle:
    """A vehicle as it flies, while the nominal one is believed.

    Attributes:
        parameters: parameters about the true centre of mass.
        centre_of_mass: place of the true centre of mass from the nominal one, forward, right, down, m.
        differences: true less nominal value, by name; none of the nominal vehicle.
    """

    parameters: Parameters
    centre_of_mass: tuple[float, float, float] = (0.0, 0.0, 0.0)
    differences: tuple[tuple[str, float], ...] = ()

    def describe(self) -> str:
        """Returns the differences as text; empty for the nominal vehicle."""
        return ", ".join(f"{name} {value:+.4g}" for name, value in self.differences)


def read_uncertainty(path: Path | None = None) -> VehicleUncertainty:
    """Reads the uncertainty of a vehicle file.

    Args:
        path: file in the format of `models/gtmax.toml`, the default.

    Raises:
        BadFileError: there is none, or a value is unknown or invalid.
    """
    path = path or models.FOLDER / "gtmax.toml"
    content = toml_table(path)
    with refusing(path):
        if "uncertainty" not in content:
            raise ValueError("expected a table uncertainty, got none")
    return parse_json(json.dumps(content["uncertainty"]), path, VehicleUncertainty)


@cache
def shipped_uncertainty() -> VehicleUncertainty:
    """Returns the uncertainty of `models/gtmax.toml`."""
    return read_uncertainty()


def draw_vehicle(
    nominal: Parameters,
    uncertainty: VehicleUncertainty,
    *,
    airframe: np.random.Generator,
    flight: np.random.Generator,
) -> DrawnVehicle:
    """Returns a vehicle drawn around the nominal one.

    Args:
        nominal: vehicle believed.
        uncertainty: standard deviations.
        airframe: generator of what stays with the airframe.
        flight: generator of what is loaded for a flight.
    """
    differences: dict[str, float] = {}
    for level, rng in ((uncertainty.airframe, airframe), (uncertainty.flight, flight)):
        for name, sigma in sorted({**level.share, **level.size}.items()):
            unit = abs(value_of(nominal, name)) if name in level.share else 1.0
            differences[name] = differences.get(name, 0.0) + sigma * unit * _draw(rng)
    return differ(nominal, differences)


def differ(nominal: Parameters, differences: Mapping[str, float]) -> DrawnVehicle:
    """Returns the vehicle that differs from the nominal one by stated amounts."""
    values = {
        name: value_of(nominal, name) + amount
        for name, amount in differences.items()
        if name not in CENTRE_OF_MASS
    }
    forward, right, down = (differences.get(name, 0.0) for name in CENTRE_OF_MASS)
    moved = {
        "main_rotor.hub_forward": -forward,
        "main_rotor.hub_right": -right,
        "main_rotor.hub_height": down,
        "tail_rotor.arm": forward,
        "tail_rotor.height": down,
        "airframe.fin_arm": forward,
        "airframe.tailplane_arm": forward,
    }
    for name, amount in moved.items():
        values[name] = values.get(name, value_of(nominal, name)) + amount
    return DrawnVehicle(with_values(nominal, values), (forward, right, down), tuple(differences.items()))


def value_of(parameters: Parameters, name: str) -> float:
    """Returns a parameter by its name; 0 for a shift."""
    if name in CENTRE_OF_MASS:
        return 0.0
    part, field = name.split(".")
    return float(getattr(getattr(parameters, part), field))


def with_values(parameters: Parameters, values: Mapping[str, Any]) -> Parameters:
    """Returns the parameters with other values or symbols, by name."""
    parts: dict[str, dict[str, Any]] = {}
    for name, value in values.items():
        part, field = name.split(".")
        parts.setdefault(part, {})[field] = value
    changed = {part: replace(getattr(parameters, part), **fields) for part, fields in parts.items()}
    return replace(parameters, **changed)


def _draw(rng: np.random.Generator) -> float:
    """Returns a standard normal number, cut at `LARGEST`."""
    while abs(drawn := float(rng.standard_normal())) > LARGEST:
        pass
    return drawn
