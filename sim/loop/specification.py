"""Specification of a flight, complete with library and code version."""

import operator
from dataclasses import dataclass, fields
from itertools import pairwise

from pydantic import Field, FiniteFloat, model_validator

from flight.errors import FlightError
from flight.mission.campaign import DEFAULT_SENSORS, VehiclePopulation
from flight.mission.fault import SENSORS, Fault
from flight.mission.sequence import Sequence
from flight.mission.wind_change import WindChange
from flight.schema import FileModel, parse_json
from flight.se2 import SE2

DEFAULT_ALTITUDE = 30.0

CONTROL_RATE = 100
"""Hz."""

WIND_FADE_TIME = 5.0
"""Seconds of the transition from one wind to the next."""

CONTROL_PERIOD = 1.0 / CONTROL_RATE


class _Pose(FileModel):
    north: FiniteFloat = 0.0
    east: FiniteFloat = 0.0
    heading: FiniteFloat = 0.0


class NoSensorsError(FlightError):
    """Sensor fault in a flight with ideal navigation."""

    def __init__(self, fault: str) -> None:
        super().__init__(f"fault {fault!r}: expected sensor models, got ideal navigation")


class NoAirframeError(FlightError):
    """Flight of one airframe without the seed that draws it."""

    def __init__(self) -> None:
        super().__init__("expected the seed of the airframe with vehicles 'one', got none")


class WindOrderError(FlightError):
    """Wind change before the end of the previous one."""

    def __init__(self, times: list[float]) -> None:
        super().__init__(
            f"expected wind changes in order and at least {WIND_FADE_TIME:g} s apart, "
            f"got {', '.join(map(str, times))} s"
        )


@dataclass(frozen=True, slots=True)
class FlightOptions:
    """Options of a flight; fields as in `FlightSpecification`."""

    ideal_navigation: bool = False
    adaptive: bool = True
    faults: tuple[Fault, ...] = ()
    supervised: bool = False
    wind_changes: tuple[WindChange, ...] = ()
    vehicles: VehiclePopulation = "nominal"
    airframe_seed: int | None = None
    sensors: str = DEFAULT_SENSORS

    def __post_init__(self) -> None:
        """Refuses what does not go together."""
        if self.vehicles == "one" and self.airframe_seed is None:
            raise NoAirframeError
        failing = [fault.words for fault in self.faults if fault.where in SENSORS]
        if self.ideal_navigation and failing:
            raise NoSensorsError(failing[0])
        times = [change.time for change in self.wind_changes]
        if any(later < before + WIND_FADE_TIME for before, later in pairwise(times)):
            raise WindOrderError(times)

    @property
    def population(self) -> str:
        """Population flown, with the airframe's seed: such as `airframe 1`."""
        return f"airframe {self.airframe_seed}" if self.vehicles == "one" else self.vehicles


DEFAULT_OPTIONS = FlightOptions()
SUPERVISED_OPTIONS = FlightOptions(supervised=True)


class FlightSpecification(FileModel):
    """Specification of one flight of the simulated helicopter.

    Attributes:
        kind: `sequence`, `campaign` or `mission`.
        name: name of the flight and of its log.
        seed: seed of all random numbers of the flight.
        wind: wind class; `calm` switches wind and turbulence off.
        wind_from: direction of origin of the mean wind at the start of settling, rad clockwise from north, to
            within the heading error of settling; random if None.
        adaptive: whether the controller's adaptive element learns.
        altitude: height above ground, m.
        ideal_navigation: whether the estimate equals the truth.
        faults: injected faults, with times from time 0.
        wind_changes: later wind classes in the order of their times.
        supervised: whether the vehicle is supervised; its first alarm ends the current primitive.
        vehicles: population of the vehicle flown; the nominal one is believed.
        airframe_seed: seed of the airframe; None but for `one`.
        sensors: class of the sensors.
        start: true pose at time 0.
        start_trim: id of the trim held at time 0 and during settling.
        settling_time: time of settling before time 0, s.
        step: plant step, s, a divisor of the control period.
        trims: trim ids of a sequence; empty for flights without one.
        coasting_times: coasting time of each trim, s.
    """

    kind: str = "sequence"
    name: str = "flight"
    seed: int = Field(ge=0)
    wind: str = "calm"
    wind_from: FiniteFloat | None = None
    adaptive: bool = True
    altitude: FiniteFloat = Field(default=DEFAULT_ALTITUDE, gt=0.0)
    ideal_navigation: bool = False
    faults: tuple[Fault, ...] = ()
    supervised: bool = Field(default=False, exclude_if=operator.not_)
    wind_changes: tuple[WindChange, ...] = Field(default=(), exclude_if=operator.not_)
    vehicles: VehiclePopulation = "nominal"
    airframe_seed: int | None = Field(default=None, ge=0)
    sensors: str = DEFAULT_SENSORS
    start: _Pose = _Pose()
    start_trim: int
    settling_time: FiniteFloat = Field(default=10.0, ge=0.0)
    step: FiniteFloat = Field(default=0.005, gt=0.0)
    trims: tuple[int, ...] = ()
    coasting_times: tuple[FiniteFloat, ...] = ()

    @model_validator(mode="after")
    def _whole_steps(self) -> "FlightSpecification":
        steps = CONTROL_PERIOD / self.step
        if round(steps) < 1 or abs(steps - round(steps)) > 1e-9:
            raise ValueError(f"step must divide {CONTROL_PERIOD} s, got {self.step} s")
        return self

    @model_validator(mode="after")
    def _check_options(self) -> "FlightSpecification":
        try:
            _ = self.flight_options
        except (NoAirframeError, NoSensorsError, WindOrderError) as error:
            raise ValueError(str(error)) from None
        return self

    @property
    def flight_options(self) -> FlightOptions:
        """Options of the flight."""
        return FlightOptions(**{field.name: getattr(self, field.name) for field in fields(FlightOptions)})

    @property
    def start_pose(self) -> SE2:
        """True pose at time 0."""
        return SE2(self.start.north, self.start.east, self.start.heading)

    @property
    def sequence(self) -> Sequence:
        """Sequence to fly.

        Raises:
            ValueError: the flight has no sequence.
        """
        return Sequence(self.name, self.start_pose, self.trims, self.coasting_times, self.wind)

    def with_options(self, flight_options: FlightOptions) -> "FlightSpecification":
        """Returns the same flight with other options."""
        changed = {field.name: getattr(flight_options, field.name) for field in fields(flight_options)}
        return self.model_copy(update=changed)

    def to_json(self) -> bytes:
        """Returns the specification as JSON, numbers exact."""
        return self.model_dump_json(indent=1).encode()


def specify_sequence(
    sequence: Sequence,
    *,
    seed: int,
    kind: str = "sequence",
    altitude: float = DEFAULT_ALTITUDE,
    ideal_navigation: bool = False,
) -> FlightSpecification:
    """Returns the specification of a sequence's flight."""
    return FlightSpecification(
        kind=kind,
        name=sequence.name,
        seed=seed,
        wind=sequence.wind,
        altitude=altitude,
        ideal_navigation=ideal_navigation,
        start=specified_pose(sequence.start),
        start_trim=sequence.trims[0],
        trims=sequence.trims,
        coasting_times=sequence.coasting_times,
    )


def specified_pose(start: SE2) -> _Pose:
    """Returns a pose as stored in a specification."""
    return _Pose(north=start.x, east=start.y, heading=start.heading)


def parse_specification(text: bytes, source: str) -> FlightSpecification:
    """Reads a specification from JSON.

    Raises:
        BadFileError: the text is invalid; the message names source and first wrong entry.
    """
    return parse_json(text, source, FlightSpecification)
