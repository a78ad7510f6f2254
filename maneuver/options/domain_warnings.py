"""Warnings about flights and plans outside a library's domain."""

import sys
from collections.abc import Iterable, Sequence

from flight.automaton.domain import air_domain_warnings, vehicle_domain_warnings, walk_domain_warnings
from flight.automaton.library import Library
from flightlog.header import FlightHeader


def warn_of_walk(library: Library, trims: Sequence[int], coasting_times: Sequence[float]) -> None:
    """Warns if a walk leaves the domain of its library."""
    _print_warnings(library, walk_domain_warnings(library, trims, coasting_times))


def warn_of_walks(library: Library, walks: Sequence[tuple[Sequence[int], Sequence[float]]]) -> None:
    """Warns if flights left the domain of their library.

    Args:
        library: of plans and flights.
        walks: trims of each flight, and the coasting time of each in seconds.
    """
    found = [walk_domain_warnings(library, trims, held) for trims, held in walks]
    if len(found) == 1:
        _print_warnings(library, found[0])
    elif any(found):
        outside = sum(bool(one) for one in found)
        _print_warnings(library, [f"{outside} of {len(found)} flights left the domain of the data"])


def warn_of_flight(library: Library, *, wind: str, altitude: float | None = None) -> None:
    """Warns if the simulated helicopter would leave a library's domain.

    Args:
        library: of the flight.
        wind: wind class of the flight.
        altitude: metres above ground; None for the library's.

    Raises:
        UnknownWindError: there is no such wind.
        UnflyableWindError: the vehicle cannot hold it.
    """
    from sim.loop.specification import DEFAULT_ALTITUDE
    from sim.vehicle.parameters import model_hash
    from sim.wind.flyable import check_flyable

    check_flyable(wind, library, height=altitude or library.conditions.altitude or DEFAULT_ALTITUDE)
    said = vehicle_domain_warnings(library, vehicle_hash=model_hash())
    stronger = _is_stronger(wind, library.conditions.wind)
    _print_warnings(
        library, [*said, *air_domain_warnings(library, wind=wind, stronger=stronger, altitude=altitude)]
    )


def warn_of_logs(library: Library, headers: Sequence[FlightHeader]) -> None:
    """Warns if flights left a library's domain."""
    said: dict[str, None] = {}
    for header in headers:
        stronger = _is_stronger(header.wind, library.conditions.wind)
        said |= dict.fromkeys(vehicle_domain_warnings(library, vehicle_hash=header.model_hash))
        said |= dict.fromkeys(air_domain_warnings(library, wind=header.wind, stronger=stronger))
    _print_warnings(library, said)


def _is_stronger(wind: str, stated: str) -> bool:
    """Returns True if one wind class is known to be stronger."""
    from sim.wind.wind_class import known_wind_class

    both = known_wind_class(wind), known_wind_class(stated)
    return both[0] is not None and both[1] is not None and both[0].wind_at_20_ft > both[1].wind_at_20_ft


def _print_warnings(library: Library, departures: Iterable[str]) -> None:
    for warning in departures:
        print(f"outside the domain of {library.name}: {warning}", file=sys.stderr)
