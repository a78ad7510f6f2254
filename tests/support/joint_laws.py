"""Joint laws with known numbers, and a library that carries them."""

from dataclasses import replace

from flight.automaton.joint_law import (
    PATH_INSTANTS,
    EntryDependence,
    ManeuverLaw,
    PathInstant,
    PreviousShift,
    Row4,
    TrimLaw,
    VelocityFluctuation,
)
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.se2 import Twist

_TENTHS: tuple[Row4, Row4, Row4, Row4] = (
    (0.01, 0.0, 0.0, 0.0),
    (0.0, 0.04, 0.0, 0.0),
    (0.0, 0.0, 0.04, 0.0),
    (0.0, 0.0, 0.0, 0.0004),
)


def maneuver_law(maneuver: Maneuver, *, previous: int) -> ManeuverLaw:
    """Returns a law about a maneuver's values, shifted by one previous maneuver."""
    moved = maneuver.displacement
    values = (maneuver.duration, moved.x, moved.y, moved.heading)
    deviations = ((0.1, 0.2, -0.2, 0.02), (-0.1, -0.2, 0.2, -0.02))
    shares = [place / (PATH_INSTANTS - 1) for place in range(PATH_INSTANTS)]
    entry = EntryDependence(
        base=values,
        previous=(PreviousShift(previous, (0.3, 0.2, -0.1, 0.05)),),
        fade_time=1.0,
        velocity=((0.1, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.5)),
        covariance=_TENTHS,
        deviations=deviations,
    )
    return ManeuverLaw(
        mean=values,
        covariance=_TENTHS,
        deviations=deviations,
        path=tuple(
            PathInstant(
                (share * moved.x, share * moved.y, share * moved.heading),
                (0.2 * share, 0.2 * share, 0.02 * share),
            )
            for share in shares
        ),
        entry=entry,
    )


def trim_law(trim: Trim) -> TrimLaw:
    """Returns a law about a trim's velocity, a tenth of a metre per second faster."""
    velocity = trim.velocity
    return TrimLaw(
        mean=Twist(velocity.forward + 0.1, velocity.side, velocity.yaw_rate),
        covariance=((0.0025, 0.0, 0.0), (0.0, 0.0025, 0.0), (0.0, 0.0, 0.000025)),
        deviations=((0.05, -0.05, 0.005), (-0.05, 0.05, -0.005)),
        within=VelocityFluctuation((0.1, 0.1, 0.01), (0.8, 0.8, 0.5)),
    )


def with_laws(library: Library) -> Library:
    """Returns the library with a law on every primitive."""
    previous = library.maneuvers[0].id
    return replace(
        library,
        trims=tuple(replace(trim, law=trim_law(trim)) for trim in library.trims),
        maneuvers=tuple(replace(row, law=maneuver_law(row, previous=previous)) for row in library.maneuvers),
    )


def without_laws(library: Library) -> Library:
    """Returns the library with constant values and errors only."""
    return replace(
        library,
        trims=tuple(replace(trim, law=None) for trim in library.trims),
        maneuvers=tuple(replace(row, law=None) for row in library.maneuvers),
    )
