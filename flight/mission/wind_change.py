"""A wind that changes in flight: when, and to which class."""

from math import isfinite

from pydantic import Field, FiniteFloat

from flight.errors import FlightError
from flight.schema import FileModel


class WindChange(FileModel):
    """One change of the wind.

    Attributes:
        time: seconds after the flight's start at which it begins to change.
        wind: wind class that it changes to.
    """

    time: FiniteFloat = Field(ge=0.0)
    wind: str


def parse_wind_change(words: str) -> WindChange:
    """Parses a change of wind from words such as `20 light`.

    Raises:
        FlightError: they describe none.
    """
    parts = words.split()
    try:
        time, wind = parts
        seconds = float(time)
    except ValueError:
        raise FlightError(f"wind change {words!r}: expected 'TIME CLASS', such as '20 light'") from None
    if not (isfinite(seconds) and seconds >= 0):
        raise FlightError(f"wind change {words!r}: expected a time >= 0 s, got {time}")
    return WindChange(time=seconds, wind=wind)
