"""Domain of a library, and warnings for flights and plans outside it."""

from collections.abc import Sequence

from .library import Library

# Metres and metres per second: what differs by less is the same.
_SPEED_TOLERANCE = 1e-6


def vehicle_domain_warnings(library: Library, *, vehicle_hash: str) -> tuple[str, ...]:
    """Returns a warning where another vehicle flies than was identified.

    Args:
        library: states its domain in its conditions; older ones in their provenance.
        vehicle_hash: SHA-256 of the parameters of the vehicle that flies.
    """
    known = library.conditions.vehicle_hash or library.provenance.get("model_hash")
    if known is None or known == vehicle_hash:
        return ()
    return (f"the vehicle is {vehicle_hash[:12]}, the library was identified from {known[:12]}",)


def air_domain_warnings(
    library: Library, *, wind: str, stronger: bool, altitude: float | None = None
) -> tuple[str, ...]:
    """Returns warnings for stronger wind and for another altitude.

    Args:
        library: states wind class and altitude.
        wind: class flown in.
        stronger: True if that is stronger than the library's.
        altitude: metres above ground; None where it is the library's.
    """
    said = []
    if stronger:
        said.append(f"the wind is {wind}, stronger than {library.conditions.wind}")
    known = library.conditions.altitude
    if None not in (known, altitude) and abs((known or 0.0) - (altitude or 0.0)) > _SPEED_TOLERANCE:
        said.append(f"the altitude is {altitude:g} m, the library's is {known:g} m")
    return tuple(said)


def walk_domain_warnings(
    library: Library, trims: Sequence[int], coasting_times: Sequence[float]
) -> tuple[str, ...]:
    """Returns warnings for trims, speeds and coasts that were never flown.

    A coast between two maneuvers that is shorter than any flown is a departure even where it is no coast at
    all: every maneuver of the flights was entered from a trim that had been held for a time. The first trim
    of a walk was held before it, and the last coast is cut by the goal, not by a maneuver.

    Args:
        library: states its domain.
        trims: ids, in the order flown.
        coasting_times: seconds in each.
    """
    conditions = library.conditions
    said = []
    if conditions.entry_trims is not None:
        strange = sorted(set(trims[:-1]) - set(conditions.entry_trims))
        if strange:
            said.append(f"no data: maneuvers leaving trims {_listed(strange)} were never flown")
    if conditions.speed_range is not None:
        slow, fast = conditions.speed_range
        speeds = {trim: library.trim(trim).velocity.forward for trim in trims}
        outside = sorted(
            t for t, v in speeds.items() if not slow - _SPEED_TOLERANCE <= v <= fast + _SPEED_TOLERANCE
        )
        if outside:
            said.append(f"trims {_listed(outside)} are outside the speeds flown, {slow:g} to {fast:g} m/s")
    if conditions.coasting_range is not None:
        said += _coast_domain_warnings(library, trims, coasting_times, *conditions.coasting_range)
    return tuple(said)


def _coast_domain_warnings(
    library: Library,
    trims: Sequence[int],
    coasting_times: Sequence[float],
    shortest: float,
    longest: float,
) -> list[str]:
    coasts = list(zip(trims, coasting_times, strict=True))
    short = sorted({trim for trim, time in coasts[1:-1] if time < shortest - _SPEED_TOLERANCE})
    long = sorted({trim for trim, time in coasts if time > longest + _SPEED_TOLERANCE})
    averaged = library.conditions.trim_error_kind == "averaged"
    said = []
    if short:
        unbounded = "; averaged errors do not bound it" if averaged else ""
        said.append(
            f"coast {_trims_phrase(short)} (< {shortest:.1f} s) is shorter than any in the data{unbounded}"
        )
    if long:
        said.append(f"coast {_trims_phrase(long)} (> {longest:.1f} s) is longer than any in the data")
    return said


def _trims_phrase(trims: Sequence[int]) -> str:
    return f"in trim {trims[0]}" if len(trims) == 1 else f"in trims {_listed(trims)}"


def _listed(trims: Sequence[int]) -> str:
    return ", ".join(map(str, trims))
