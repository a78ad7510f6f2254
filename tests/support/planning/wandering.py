"""Libraries of one walk at random, with errors of everything."""

import numpy as np

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist


def wandering(rng: np.random.Generator, turns: str) -> Library:
    """A chain of trims, s for straight and t for turn, with errors of about a tenth."""
    trims = tuple(
        Trim(
            place,
            kind,
            Twist(
                rng.uniform(1, 4),
                rng.normal() * 0.3,
                rng.choice([-1, 1]) * rng.uniform(0.2, 0.7) * (kind == "t"),
            ),
            Twist(rng.uniform(0, 0.3), rng.uniform(0, 0.3), rng.uniform(0, 0.02)),
        )
        for place, kind in enumerate(turns, start=1)
    )
    joints = tuple(
        Maneuver(
            place,
            place,
            place + 1,
            rng.uniform(2, 4),
            SE2(rng.uniform(2, 8), rng.normal() * 2, rng.normal() * 0.8),
            ManeuverError(-0.4, rng.normal() * 0.5, rng.normal() * 0.5, rng.normal() * 0.1),
        )
        for place in range(1, len(turns))
    )
    return Library("wandering", "", "", trims, joints)
