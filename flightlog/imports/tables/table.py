"""Columns of a table by our names, and their choices."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from flight.errors import FlightError
from flightlog.consistency import LARGEST_VALUE
from flightlog.imports.clock import SECONDS
from flightlog.imports.motion.frames import Frames
from flightlog.imports.motion.units import Quantity
from flightlog.topics import MAX_INPUTS

from .cells import Cells
from .dialect import Dialect, dialect_of
from .headings import (
    GEODETIC,
    MEASURED,
    POSITION,
    TIME_UNITS,
    guesses,
    place_of,
    select_columns,
    unit_of,
)

_MOST_VEHICLES = 50

Columns = dict[str, Float[np.ndarray, "n"]]


@dataclass(frozen=True, slots=True)
class TableSettings:
    """Choices of the import of a table.

    Attributes:
        columns: headings, or `#N`, by our names; not needed for headings that are such names.
        commands: headings of commands.
        frames: axes of world, body and velocities.
        units: stated units by quantity; they come before those of headings.
        rate: rate of rows at equal intervals in Hz, in place of times.
        part: number of the part of a file with several.
        vehicle: vehicle of a table of several.
        unchecked: True to read numbers that contradict one another.
    """

    columns: Mapping[str, str] = field(default_factory=dict)
    commands: tuple[str, ...] = ()
    frames: Frames = field(default_factory=Frames)
    units: Mapping[Quantity, str] = field(default_factory=dict)
    rate: float | None = None
    part: int | None = None
    vehicle: str | None = None
    unchecked: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns of a table by our names, in SI units.

    Attributes:
        numbers: columns of numbers.
        commands: columns of commands by heading.
        vehicles: column of vehicles, if there is one.
        described: heading and unit of each column.
        unused: headings not used.
        units: units that the table or an option states, by quantity.
        left_out: rows with more cells than the table has columns.
    """

    numbers: Columns
    commands: Columns
    vehicles: np.ndarray[Any, Any] | None
    described: dict[str, str]
    unused: tuple[str, ...]
    units: dict[Quantity, str]
    left_out: int

    def rows(self, rows: Int[np.ndarray, "k"] | Bool[np.ndarray, "n"]) -> "Table":
        """Returns the table with some of its rows."""
        return replace(
            self,
            numbers={name: column[rows] for name, column in self.numbers.items()},
            commands={name: column[rows] for name, column in self.commands.items()},
            vehicles=None if self.vehicles is None else self.vehicles[rows],
        )


def read_table(path: Path, settings: TableSettings) -> Table:
    """Reads the columns that are stated or have our names.

    Raises:
        FlightError: the file is no such table, or lacks a column.
    """
    try:
        dialect = dialect_of(path)
        columns = settings.columns
        places = select_columns(_certain_headings(dialect, settings), columns)
        if len(settings.commands) > MAX_INPUTS:
            raise FlightError(
                f"--command: expected at most {MAX_INPUTS} columns, got {len(settings.commands)}"
            )
        commands = {heading: place_of(dialect.headings, heading) for heading in settings.commands}
        if settings.rate is not None:
            places.pop("time", None)
        elif "time" not in places:
            listed = ", ".join(guesses(dialect.headings))[:600]
            raise FlightError(f"expected --columns time=COLUMN, or --rate HZ; it has {listed or 'none'}")
        vehicle = places.pop("id", None)
        if set(POSITION[:2]) <= places.keys() and not set(GEODETIC[:2]) & set(columns):
            places = {name: place for name, place in places.items() if name not in GEODETIC}
        wanted = [*places.values(), *commands.values()]
        cells = Cells(path, dialect, wanted, time=places.get("time"), text=vehicle)
    except OSError as error:
        raise FlightError(f"cannot be read: {error.strerror or error}") from None
    numbers: Columns = {}
    described: dict[str, str] = {}
    units: dict[Quantity, str] = {**settings.units}
    for name, place in places.items():
        heading = _heading(dialect, place)
        row = dialect.units[place] if place < len(dialect.units) else ""
        unit = None if name == "time" and cells.clock else unit_of(name, heading, row, settings.units)
        column = cells.numbers[place]
        if name != "time":
            # Beyond any plausible value: no measurement.
            column = np.where(np.abs(column) < LARGEST_VALUE, column, np.nan) * (unit[1] if unit else 1.0)
        numbers[name] = column
        described[name] = f"{heading} in {unit[0]}" if unit else heading
        if unit:
            units[MEASURED[name]] = TIME_UNITS.get(unit[0], unit[0]) if name == "time" else unit[0]
    if settings.rate is not None:
        numbers["time"] = np.arange(cells.count) / settings.rate
    if settings.rate is not None or cells.clock:
        units["time"] = "s"
    used = {*wanted, *([] if vehicle is None else [vehicle])}
    return Table(
        numbers,
        {heading: cells.numbers[place] for heading, place in commands.items()},
        cells.texts,
        described,
        tuple(heading for place, heading in enumerate(dialect.headings) if place not in used and heading),
        units,
        cells.left_out,
    )


def of_one_vehicle(table: Table, vehicle: str | None) -> Table:
    """Returns the rows of one vehicle.

    Raises:
        FlightError: there are several and none is chosen, or the chosen one has no rows.
    """
    if table.vehicles is None:
        if vehicle is not None:
            raise FlightError("--vehicle-id: expected a column named id, or --columns id=COLUMN")
        return table
    names, where = np.unique(table.vehicles, return_inverse=True)
    labels = [_label(str(name)) for name in names]
    if vehicle is None:
        # Numbers of rows or messages are no vehicles.
        if len(labels) == 1 or len(labels) > _MOST_VEHICLES:
            return table
        raise FlightError(f"has several vehicles: give --vehicle-id, one of {', '.join(labels)}")
    if _label(vehicle) not in labels:
        raise FlightError(f"no vehicle {vehicle}; it has {', '.join(labels[:_MOST_VEHICLES])}")
    return table.rows(where == labels.index(_label(vehicle)))


def seconds_of(table: Table) -> Float[np.ndarray, "n"]:
    """Returns the times in seconds."""
    return SECONDS.get(table.units.get("time", "s"), 1.0) * table.numbers["time"]  # type: ignore[call-overload, no-any-return]


def _certain_headings(dialect: Dialect, settings: TableSettings) -> tuple[str, ...]:
    """Returns the headings; none if the columns have numbers instead.

    Raises:
        FlightError: the rows are longer than the headings, and columns are not stated by number.
    """
    if not dialect.longer:
        return dialect.headings
    if settings.columns and all(heading.startswith("#") for heading in settings.columns.values()):
        return ()
    first = " ".join(",".join(dialect.longer).split())[:200]
    raise FlightError(
        f"has {len(dialect.headings)} headings above rows of {len(dialect.longer)} cells: give --columns "
        f"NAME=#N, N the number of the column from 1; its first row is {first}"
    )


def _heading(dialect: Dialect, place: int) -> str:
    return dialect.headings[place] if place < len(dialect.headings) else f"#{place + 1}"


def _label(text: str) -> str:
    """Returns the name of a vehicle; 1.000 is 1."""
    try:
        return f"{float(text):g}"
    except ValueError:
        return text.strip()
