"""Sequence: trims flown in order, with a coasting time each."""

from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field, FiniteFloat, model_validator

from flight.schema import FileModel, read_toml, refusing, schema_named
from flight.se2 import SE2

from .mission import Heading, Place

SCHEMA = "maneuver-sequence/1"
"""Schema name that a file may state; without one it is of this version."""


@dataclass(frozen=True, slots=True)
class Sequence:
    """A walk in the maneuver automaton with its coasting times.

    Attributes:
        name: short name.
        start: pose at time 0, metres and radians.
        trims: ids, the first is held at time 0.
        coasting_times: seconds, one for each trim.
        wind: wind class.
    """

    name: str
    start: SE2
    trims: tuple[int, ...]
    coasting_times: tuple[float, ...]
    wind: str = "calm"

    def __post_init__(self) -> None:
        """Refuses a walk that cannot be flown."""
        if not self.trims:
            raise ValueError("trims: expected at least one, got none")
        if len(self.trims) != len(self.coasting_times):
            raise ValueError(
                f"coasting_times: expected one for each of the {len(self.trims)} trims, "
                f"got {len(self.coasting_times)}"
            )
        for time in self.coasting_times:
            if not (isfinite(time) and time >= 0):
                raise ValueError(f"coasting_times must be >= 0 s, got {time} s")


class _Start(FileModel):
    position: tuple[Place, Place] = (0.0, 0.0)
    heading: Heading = 0.0


class _Uniform(FileModel):
    """Coasting times drawn uniformly between two bounds, in seconds."""

    shortest: FiniteFloat = Field(ge=0)
    longest: FiniteFloat = Field(ge=0)
    seed: int = Field(ge=0)

    @model_validator(mode="after")
    def _ordered(self) -> "_Uniform":
        if self.longest < self.shortest:
            raise ValueError(f"longest must be >= shortest ({self.shortest} s), got {self.longest} s")
        return self


class _SequenceFile(FileModel):
    schema_name: Annotated[str, schema_named(SCHEMA)] = Field(default=SCHEMA, alias="schema")
    name: str
    start: _Start = _Start()
    trims: list[int]
    coasting_times: list[FiniteFloat] | _Uniform
    wind: str = "calm"


def read_sequence(path: Path) -> Sequence:
    """Reads `sequences/NAME.toml`.

    Raises:
        BadFileError: the file is missing, is no TOML, or lacks or misnames a part.
    """
    content = read_toml(path, _SequenceFile)
    with refusing(path):
        times = content.coasting_times
        if isinstance(times, _Uniform):
            rng = np.random.default_rng(times.seed)
            times = rng.uniform(times.shortest, times.longest, len(content.trims)).tolist()
        return Sequence(
            name=content.name,
            start=SE2(*content.start.position, content.start.heading),
            trims=tuple(content.trims),
            coasting_times=tuple(times),
            wind=content.wind,
        )
