"""Time bound: a factor on the predicted time, found by flights.

It is no part of a library, whose numbers are of primitives, but stands beside it: `NAME.times.toml` beside
`NAME.json`, with the library's hash.
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
"""Factor that a file may state: a plan's time times this stays finite."""


@dataclass(frozen=True, slots=True)
class TimeBound(FileValue):
    """Share of flights that finish within a multiple of the predicted time.

    Attributes:
        policy: of the plans.
        gamma: uncertainty level of the plans.
        wind: class in which the helicopter flew.
        share: of flights, or more, with 95 % confidence.
        factor: on the seconds of a plan to the part of the tolerance that the loop aims at, and its latency.
        missions: that it was found on.
        flights: likewise, all missions together.
        seed: that they were drawn with.
        time: seconds that this is for one plan; None where it is said of none.
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
        """From what it was found, for people."""
        return f"{self.missions} missions, {self.flights} flights in wind {self.wind}, seed {self.seed}"

    @property
    def sentence(self) -> str:
        """Time bound in words."""
        multiple = f"{self.factor:.2f} × predicted"
        when = multiple if self.time is None else f"{self.time:.1f} s ({multiple})"
        return f"{self.share:.0%} of flights finish within {when}, 95% confidence, from {self.source}"


class _TimeBoundsFile(FileModel):
    schema_name: Literal["maneuver-times/1"] = Field(alias="schema")
    library_hash: str
    promise: tuple[TimeBound, ...] = Field(min_length=1)

    @field_validator("promise")
    @classmethod
    def _no_time(cls, promises: tuple[TimeBound, ...]) -> tuple[TimeBound, ...]:
        for place, one in enumerate(promises):
            if one.time is not None:
                raise ValueError(f"[{place}].time: expected none beside a library, got {one.time} s")
        return promises


def time_bounds_path(library: Path) -> Path:
    """Returns where the promises of a library stand."""
    return library.with_name(library.stem + SUFFIX)


def time_bounds_text(promises: Sequence[TimeBound], *, library_hash: str, command: str) -> str:
    """Returns promises as their file's text.

    Args:
        promises: found with one library; at least one, for a file without is none.
        library_hash: of that.
        command: that found them.
    """
    lines = [f"# {command}", 'schema = "maneuver-times/1"', f'library_hash = "{library_hash}"']
    for one in promises:
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
        library: its path.
        library_hash: of it.

    Returns:
        None where the file was found with another library: that promises nothing of this one.

    Raises:
        BadFileError: the file is broken.
    """
    path = time_bounds_path(library)
    if not path.exists():
        return ()
    content = read_toml(path, _TimeBoundsFile)
    return content.promise if content.library_hash == library_hash else None
