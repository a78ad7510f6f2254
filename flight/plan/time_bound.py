"""Time bound: a factor on the predicted time, found by flights.

It is not part of a library, which holds numbers of primitives. The file `NAME.times.toml` beside `NAME.json`
holds it, with the library's hash.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, NonNegativeInt, PositiveFloat, PositiveInt, field_validator

from flight.file_value import FileValue
from flight.schema import FileModel, read_toml

SUFFIX = ".times.toml"

LARGEST_FACTOR = 1e6
"""Largest factor in a file: a plan's time times this stays finite."""


@dataclass(frozen=True, slots=True)
class TimeBound(FileValue):
    """Share of flights that finish within a multiple of the predicted time.

    Attributes:
        policy: policy of the plans.
        gamma: uncertainty level of the plans.
        wind: wind class of the flights.
        share: least share of flights, with 95 % confidence.
        factor: factor on the predicted time: latency plus the time of a plan to the replans' share of the
            tolerance.
        missions: number of missions that it was found with.
        flights: number of flights of all these missions.
        seed: seed of the missions.
        time: seconds for one plan; None if it is of no plan.
    """

    policy: str
    gamma: float
    wind: str
    share: Annotated[float, Field(gt=0, lt=1)]
    factor: Annotated[float, Field(gt=0, le=LARGEST_FACTOR)]
    missions: PositiveInt
    flights: PositiveInt
    seed: NonNegativeInt
    time: PositiveFloat | None = None

    @property
    def source(self) -> str:
        """Missions, flights and wind in words."""
        return f"{self.missions} missions, {self.flights} flights in wind {self.wind}, seed {self.seed}"

    @property
    def sentence(self) -> str:
        """Time bound in words."""
        multiple = f"{self.factor:.2f} × predicted"
        limit = f"{multiple} (" if self.time is None else f"{self.time:.1f} s ({multiple}, "
        share = f"{100 * self.share:.0f} %"
        return f"{share} of flights finish within {limit}95 % confidence), from {self.source}"


class _TimeBoundsFile(FileModel):
    schema_name: Literal["maneuver-times/1"] = Field(alias="schema")
    library_hash: str
    promise: tuple[TimeBound, ...] = Field(min_length=1)

    @field_validator("promise")
    @classmethod
    def _no_time(cls, bounds: tuple[TimeBound, ...]) -> tuple[TimeBound, ...]:
        for place, one in enumerate(bounds):
            if one.time is not None:
                raise ValueError(f"[{place}].time: expected none beside a library, got {one.time} s")
        return bounds


def time_bounds_path(library: Path) -> Path:
    """Returns the path of a library's time bounds."""
    return library.with_name(library.stem + SUFFIX)


def time_bounds_text(bounds: Sequence[TimeBound], *, library_hash: str, command: str) -> str:
    """Returns the text of a file of time bounds.

    Args:
        bounds: at least one, all of one library.
        library_hash: hash of the library.
        command: command line of the flights.
    """
    lines = [f"# {command}", 'schema = "maneuver-times/1"', f'library_hash = "{library_hash}"']
    for one in bounds:
        lines += [
            "",
            "[[promise]]",
            f'policy = "{one.policy}"',
            f"gamma = {float(one.gamma)!r}",
            f'wind = "{one.wind}"',
            f"share = {float(one.share)!r}",
            f"factor = {float(one.factor)!r}",
            f"missions = {one.missions}",
            f"flights = {one.flights}",
            f"seed = {one.seed}",
        ]
    return "\n".join(lines) + "\n"


def read_time_bounds(library: Path, *, library_hash: str) -> tuple[TimeBound, ...] | None:
    """Returns the time bounds stated beside a library; none without a file.

    Args:
        library: path of the library.
        library_hash: hash of the library.

    Returns:
        None if the file is of another library.

    Raises:
        BadFileError: the file is broken.
    """
    path = time_bounds_path(library)
    if not path.exists():
        return ()
    content = read_toml(path, _TimeBoundsFile)
    return content.promise if content.library_hash == library_hash else None
