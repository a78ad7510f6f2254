"""How often flights left their tube, beside how often the library's claims allow it."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from experiments.mission.policies import FlownPolicy
from experiments.mission.result import MissionResult
from flight.automaton.library import Library

_Key = tuple[FlownPolicy, float, str, float]

DOUBT = 0.01
"""Chance below which a claim counts as refuted."""


@dataclass(frozen=True, slots=True)
class TubeTrial:
    """Flights of one policy in one wind class against one tube.

    Attributes:
        policy: which planner.
        gamma: uncertainty level planned for.
        wind: wind class.
        share: of the library's errors that the tube is made of.
        flights: in which every primitive flown claims a coverage.
        left: that left their tube.
        allowed: by the claims, at most, on the average.
        chance: of so many that left it, or more, if the claims held; an upper limit.
    """

    policy: FlownPolicy
    gamma: float
    wind: str
    share: float
    flights: int
    left: int
    allowed: float
    chance: float

    @property
    def refuted(self) -> bool:
        """Whether the flights contradict the claims."""
        return self.chance < DOUBT


def tube_trials(results: Iterable[MissionResult], library: Library) -> tuple[TubeTrial, ...]:
    """Returns a card for each policy, level, wind class and tube.

    A primitive claims a share of flights in which all its performances stay inside its errors. A flight that
    leaves its tube has left the errors of one of its primitives: that happens in no larger share of flights
    than what the claims of its different primitives leave, all together, whatever else they have in common.
    Flights of one policy are independent of one another; those of two meet the same air. Their allowed shares
    differ.
    """
    found: dict[_Key, list[tuple[bool, float]]] = {}
    for row in results:
        allowed = allowed_share(row, library)
        for share, left in row.left_tube:
            if allowed is not None:
                key = (row.policy, row.gamma, row.wind, share)
                found.setdefault(key, []).append((left is not None, allowed))
    return tuple(_tube_trial(*key, flights=flights) for key, flights in found.items())


def allowed_share(row: MissionResult, library: Library) -> float | None:
    """Returns the share of such flights that may leave their tube; None where a primitive claims nothing."""
    trims = {leg.trim for leg in row.legs if leg.to_trim is None}
    changes = {(leg.trim, leg.to_trim) for leg in row.legs if leg.to_trim is not None}
    statistics = [library.trim(trim).statistics for trim in trims]
    statistics += [library.maneuver(*change).statistics for change in changes]
    claimed = [known.coverage for known in statistics if known is not None]
    if len(claimed) < len(statistics) or not claimed:
        return None
    return min(1.0, sum(1.0 - coverage for coverage in claimed))


def _tube_trial(
    policy: FlownPolicy, gamma: float, wind: str, share: float, *, flights: Sequence[tuple[bool, float]]
) -> TubeTrial:
    left = sum(gone for gone, _ in flights)
    allowed = [share for _, share in flights]
    return TubeTrial(
        policy=policy,
        gamma=gamma,
        wind=wind,
        share=share,
        flights=len(flights),
        left=left,
        allowed=float(np.mean(allowed)),
        chance=float(count_distribution(allowed)[left:].sum()),
    )


def count_distribution(shares: Sequence[float]) -> Float[np.ndarray, "n"]:
    """Returns the law of how many of independent things happen, each with a chance of its own."""
    law = np.ones(1)
    for share in shares:
        law = np.append(law, 0.0) * (1.0 - share) + np.append(0.0, law) * share
    return law
