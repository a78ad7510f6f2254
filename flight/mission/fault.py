"""Faults of a flight: place, kind, start, duration, size.

In words, as on the command line: where, what, start and duration in seconds (`inf` for the rest of the
flight), then the sizes of its kind: `gps dropout 10 2`, `gyro bias 5 inf 0 0 0.05`, `pedal slow 12 4 0.1`.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import inf, isfinite, isnan

from pydantic import Field, FiniteFloat, ValidationError, model_validator

from flight.errors import FlightError
from flight.schema import FileModel, first_problem

SENSORS = ("gyro", "accelerometer", "gps", "magnetometer", "altimeter")
SERVOS = ("lateral", "longitudinal", "collective", "pedal")


@dataclass(frozen=True, slots=True)
class FaultParameter:
    """Parameter of a fault: name, unit, least and largest value."""

    name: str
    unit: str
    low: float = -inf
    high: float = inf


@dataclass(frozen=True, slots=True)
class FaultKind:
    """Kind of fault of one place.

    Attributes:
        where: sensor, servo, `controller`, `wind` or `vehicle`.
        what: one word.
        meaning: effect in words.
        sizes: numbers that say by how much.
        effect: meaning of the number in the log's `/fault_effect`; 0 without an effect.
        unit: of the effect.
        ends: True if it must end.
    """

    where: str
    what: str
    meaning: str
    sizes: tuple[FaultParameter, ...]
    effect: str
    unit: str
    ends: bool = False

    @property
    def words(self) -> str:
        """The form of the fault, such as `gyro bias START DURATION FORWARD RIGHT DOWN`."""
        sizes = (size.name.upper() for size in self.sizes)
        return " ".join((self.where, self.what, "START DURATION", *sizes))


def _fault_kinds() -> Iterator[FaultKind]:
    """Yields every kind, sensors first."""
    body, world = ("forward", "right", "down"), ("north", "east", "down")
    readings = dict(
        zip(
            SENSORS,
            (("rad/s", body), ("m/s2", body), ("m", world), ("rad", ("angle",)), ("m", ("height",))),
            strict=True,
        )
    )
    for sensor, (unit, axes) in readings.items():
        off = f"how far the reading is from that of the sound {sensor}"
        nothing = (
            "silent, the last reading is used on" if sensor in SENSORS[:2] else "silent, nothing is corrected"
        )
        yield FaultKind(sensor, "dropout", nothing, (), "readings withheld so far", "-")
        yield FaultKind(sensor, "stuck", "gives its last reading again and again", (), off, unit)
        sizes = tuple(FaultParameter(axis, unit) for axis in axes)
        yield FaultKind(sensor, "bias", "reads more by a constant", sizes, off, unit)
        later = (FaultParameter("time", "s", low=0.01, high=5.0),)
        yield FaultKind(sensor, "delay", "each reading comes later, as if it were new", later, off, unit)
    for servo in SERVOS:
        off = f"how much faster a sound {servo} servo would have moved"
        yield FaultKind(servo, "jam", "stays where it is", (), off, "rad/s")
        left = (FaultParameter("share", "-", low=0.0, high=1.0),)
        yield FaultKind(servo, "slow", "moves at a share of its largest rate", left, off, "rad/s")
        lag = (FaultParameter("time", "s", low=0.01, high=10.0),)
        yield FaultKind(servo, "lag", "follows its command with this time constant", lag, off, "rad/s")
    age = "age of the command beyond one control period"
    late = (FaultParameter("time", "s", low=0.01, high=2.0),)
    yield FaultKind("controller", "late", "each command comes later", late, age, "s")
    rest = (FaultParameter("periods", "-", low=2.0, high=1000.0),)
    yield FaultKind("controller", "misses", "of so many periods only the first is done", rest, age, "s")
    gust = tuple(FaultParameter(axis, "m/s") for axis in world)
    blows = "the air's velocity comes and goes, one minus cosine"
    yield FaultKind("wind", "gust", blows, gust, "speed of the gust", "m/s", ends=True)
    factor = (FaultParameter("factor", "-", low=0.1, high=10.0),)
    yield FaultKind("vehicle", "mass", "mass times a factor", factor, "mass beyond what was", "kg")
    yield FaultKind("vehicle", "lift", "main rotor's lift slope times a factor", factor, "factor less 1", "-")


FAULT_KINDS = {(kind.where, kind.what): kind for kind in _fault_kinds()}
"""Every kind of fault by where and what."""


class Fault(FileModel):
    """One fault of one flight.

    Attributes:
        where: sensor, servo, `controller`, `wind` or `vehicle`.
        what: kind of fault there.
        start: s after the flight's start.
        duration: s; None for the rest of the flight.
        size: numbers that say by how much, as many as the kind has.
    """

    where: str
    what: str
    start: FiniteFloat = Field(ge=0.0)
    duration: FiniteFloat | None = Field(default=None, gt=0.0)
    size: tuple[FiniteFloat, ...] = ()

    @model_validator(mode="after")
    def _check_kind(self) -> "Fault":
        kind = self.kind
        if len(self.size) != len(kind.sizes):
            raise ValueError(f"expected {kind.words!r}, got {len(self.size)} sizes")
        for value, size in zip(self.size, kind.sizes, strict=True):
            if not size.low <= value <= size.high:
                unit = "" if size.unit == "-" else f" {size.unit}"
                raise ValueError(
                    f"{self.where} {self.what}: {size.name} must lie in [{size.low:g}, {size.high:g}]{unit}, "
                    f"got {value:g}"
                )
        if kind.ends and self.duration is None:
            raise ValueError(f"{self.where} {self.what}: expected a duration in s, got none")
        return self

    @property
    def kind(self) -> FaultKind:
        """Kind of the fault, with what holds for all of its kind.

        Raises:
            ValueError: there is no such kind.
        """
        try:
            return FAULT_KINDS[self.where, self.what]
        except KeyError:
            raise ValueError(_unknown_kind_message(self.where, self.what)) from None

    @property
    def end(self) -> float:
        """Seconds after the flight's start; infinite where it lasts."""
        return inf if self.duration is None else self.start + self.duration

    @property
    def words(self) -> str:
        """The fault as `parse_fault` reads it."""
        numbers = (self.start, inf if self.duration is None else self.duration, *self.size)
        return " ".join((self.where, self.what, *(f"{number:.12g}" for number in numbers)))


class BadFaultError(FlightError):
    """Words that describe no fault."""

    def __init__(self, words: str, problem: str) -> None:
        super().__init__(f"fault {words!r}: {problem}")


def parse_fault(words: str) -> Fault:
    """Reads a fault from words.

    Raises:
        BadFaultError: they describe none.
    """
    parts = words.split()
    where, what = (*parts, "", "")[:2]
    rest = parts[2:]
    if (where, what) not in FAULT_KINDS:
        raise BadFaultError(words, _unknown_kind_message(where, what))
    form = FAULT_KINDS[where, what].words
    try:
        start, duration, *size = map(float, rest)
    except ValueError:
        raise BadFaultError(words, f"expected {form!r} with numbers, got {' '.join(rest)!r}") from None
    if not all(isfinite(number) for number in (start, *size)) or isnan(duration):
        raise BadFaultError(words, "expected finite numbers; only the duration may be `inf`")
    try:
        return Fault(
            where=where,
            what=what,
            start=start,
            duration=None if duration == inf else duration,
            size=tuple(size),
        )
    except ValidationError as error:
        raise BadFaultError(words, first_problem(error)) from None


def _unknown_kind_message(where: str, what: str) -> str:
    """Returns the message for an unknown kind, with the known ones."""
    here = [kind.what for kind in FAULT_KINDS.values() if kind.where == where]
    if here:
        return f"no {what!r} of {where}; expected one of {here}"
    return f"no place {where!r}; faults have {_unique_in_order(kind.where for kind in FAULT_KINDS.values())}"


def _unique_in_order(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))
