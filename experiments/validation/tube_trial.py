"""Test of tubes: exits compared with those that the claims allow."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from experiments.mission.policies import FlownPolicy
from experiments.mission.result import MissionResult
from flight.automaton.library import Library

_Key = tuple[FlownPolicy, float, str, float]

LEVEL = 0.01
"""P-value below which a claim counts as refuted."""


@dataclass(frozen=True, slots=True)
class TubeTrial:
    """Flights of one policy in one wind class against one tube.

    Attributes:
        policy: policy of the planner.
        gamma: gamma of the plans.
        wind: wind class.
        share: scale of the library's errors for the tube.
        flights: flights in which every primitive has a coverage claim.
        left: flights that left their tube.
        allowed: mean upper limit of the share that the claims allow to leave.
        p_value: upper limit of the probability of at least this many exits if the claims are true.
    """

    policy: FlownPolicy
    gamma: float
    wind: str
    share: float
    flights: int
    left: int
    allowed: float
    p_value: float

    @property
    def refuted(self) -> bool:
        """True if the flights contradict the claims."""
        return self.p_value < LEVEL


def tube_trials(results: Iterable[MissionResult], library: Library) -> tuple[TubeTrial, ...]:
    """Returns a trial per policy, gamma, wind class and tube.

    A primitive's coverage is the share of flights in which all its performances stay inside its errors. A
    flight that leaves its tube has exceeded the errors of one of its primitives; by the union bound, the
    share of such flights is at most the sum of the complements of the coverages. Flights of one policy are
    independent and have different allowed shares; policies share the wind.
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
    """Returns the share allowed to leave the tube; None without claims."""
    trims = {leg.trim for leg in row.legs if leg.to_trim is None}
    changes = {(leg.trim, leg.to_trim) for leg in row.legs if leg.to_trim is not None}
    held = [library.trim(trim) for trim in trims]
    flown = [library.maneuver(*change) for change in changes]
    statistics = [*(trim.statistics for trim in held), *(part.statistics for part in flown)]
    claimed = [known.coverage for known in statistics if known is not None]
    if len(claimed) < len(statistics) or not claimed:
        return None
    # The tube is that of the errors and of the laws' bounds: either may be left.
    claimed += [trim.law.coverage for trim in held if trim.law is not None and trim.law.coverage]
    claimed += [
        part.law.entry.coverage
        for part in flown
        if part.law is not None and part.law.entry is not None and part.law.claims_entries
    ]
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
        p_value=float(count_distribution(allowed)[left:].sum()),
    )


def count_distribution(shares: Sequence[float]) -> Float[np.ndarray, "n"]:
    """Returns the Poisson-binomial distribution of a count."""
    law = np.ones(1)
    for share in shares:
        law = np.append(law, 0.0) * (1.0 - share) + np.append(0.0, law) * share
    return law
