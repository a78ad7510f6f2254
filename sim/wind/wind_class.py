"""Wind classes, and the mean wind at a height.

A class is a wind at 20 ft (W20), the standard's measure of mean wind and turbulence. At another height the
mean wind follows the logarithmic profile of MIL-F-8785C, 3.7.3.2 (MIL-HDBK-1797, low altitude).
"""

from dataclasses import dataclass
from math import inf, log

import casadi as ca

from flight.errors import FlightError
from flight.units import FOOT

_KNOT = 1852.0 / 3600.0
ROUGHNESS_LENGTH = 0.15 * FOOT
"""Height at which the profile is zero, m: the standard's value for terminal flight phases."""

# Heights of the profile, m.
_LOWEST, _HIGHEST = 3.0 * FOOT, 1000.0 * FOOT
_AT_20_FT = log(20.0 * FOOT / ROUGHNESS_LENGTH)


@dataclass(frozen=True, slots=True)
class WindClass:
    """Wind class: a wind at 20 ft.

    Attributes:
        name: name in missions, sequences and libraries.
        wind_at_20_ft: wind at 20 ft, m/s.
    """

    name: str
    wind_at_20_ft: float

    def mean_wind(self, height: float) -> float:
        """Returns the mean wind at a height in m, m/s."""
        return self.wind_at_20_ft * float(wind_profile(height))


# The standard's light, moderate and severe are 15, 30, 45 kt. `gtmax` is the wind in which maneuver errors
# are those of the thesis's Table 10 (`python -m benchmarks.identification.wind_of_table_10`).
WIND_CLASSES = {
    wind.name: wind
    for wind in (
        WindClass("calm", 0.0),
        WindClass("gtmax", 4.0),
        WindClass("light", 15.0 * _KNOT),
        WindClass("moderate", 30.0 * _KNOT),
        WindClass("severe", 45.0 * _KNOT),
    )
}


class UnknownWindError(FlightError):
    """Name of a wind class that does not exist."""

    def __init__(self, name: str) -> None:
        super().__init__(
            f"no wind class {name!r}; there are {list(WIND_CLASSES)}, "
            "or the wind at 20 ft in m/s, such as '4.5'"
        )


def wind_class(name: str) -> WindClass:
    """Returns a wind class by name or W20 in m/s.

    Raises:
        UnknownWindError: it does not exist.
    """
    found = known_wind_class(name)
    if found is None:
        raise UnknownWindError(name)
    return found


def known_wind_class(name: str) -> WindClass | None:
    """Returns a wind class as `wind_class` does; None for an unknown one."""
    if name in WIND_CLASSES:
        return WIND_CLASSES[name]
    try:
        wind_at_20_ft = float(name)
    except ValueError:
        return None
    return WindClass(name, wind_at_20_ft) if 0.0 <= wind_at_20_ft < inf else None


def wind_profile(height: float) -> float:
    """Returns mean wind over that at 20 ft, also of a symbol.

    Args:
        height: height above ground, m, clamped to 3 to 1000 ft.
    """
    return ca.log(ca.fmax(_LOWEST, ca.fmin(_HIGHEST, height)) / ROUGHNESS_LENGTH) / _AT_20_FT
