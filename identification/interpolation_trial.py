"""Whether a grown library keeps its promise: primitives drawn from it, flown, against its claim.

The claim is of a kind: a share of at least `coverage` of its grown primitives holds so many flights. A drawn
primitive is kept when each new flight that shows it, no more of them than claimed, is inside; so the number
of kept ones among those drawn is binomial with at least that share, if the claim is true.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from scipy.stats import binom

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.statistics import InterpolationClaim
from flight.automaton.trim import Trim
from flight.errors import FlightError
from identification.design.interpolation_schedule import PrimitiveSample
from identification.segmentation.flight_evidence import FlightEvidence

from .coverage_trial import adjust_p_values, check_consistency, clopper_pearson_interval, count_inside

Kind = Literal["trim", "maneuver"]


@dataclass(frozen=True, slots=True)
class PrimitiveTrial:
    """What new flights did with one primitive that was drawn.

    Attributes:
        kind: of the primitive.
        id: of the trim or maneuver.
        flights: new flights that show it, lost and unsettled ones included.
        inside: flights in which all numbers stayed inside the bounds.
        unsettled: flights in which it did not settle or that were lost; they count as outside.
    """

    kind: Kind
    id: int
    flights: int
    inside: int
    unsettled: int

    @property
    def kept(self) -> bool:
        """Whether every flight was inside."""
        return self.inside == self.flights


@dataclass(frozen=True, slots=True)
class InterpolationTrial:
    """The claim of a kind beside what the drawn primitives did.

    Attributes:
        kind: trims or maneuvers.
        claim: of the kind.
        drawn: primitives that flights show.
        kept: of them, those with every flight inside.
        low: lower end of the exact (Clopper-Pearson) 95 % interval of the share kept.
        high: upper end.
        doubt: probability of so few kept if the claim were true, after Holm's correction for both kinds.
        refuted: whether that is too improbable.
    """

    kind: Kind
    claim: InterpolationClaim
    drawn: int
    kept: int
    low: float
    high: float
    doubt: float
    refuted: bool


def interpolation_trials(
    library: Library, drawn: PrimitiveSample, flights: Sequence[FlightEvidence], *, level: float = 0.05
) -> tuple[tuple[PrimitiveTrial, ...], tuple[InterpolationTrial, ...]]:
    """Returns what flights did with each primitive drawn, and a trial for each kind.

    Args:
        library: grown.
        drawn: primitives of it, at random.
        flights: new ones, no more than the claim is for.
        level: of the test of both kinds together.

    Raises:
        FlightError: there are more flights than the claim is for.
        InconsistentLogsError: a flight was flown with other trims, maneuvers or another rule.
    """
    check_consistency(library, flights)
    shown = [
        PrimitiveTrial(kind, part.id, *count_inside(library, part, flights))
        for kind, part in _sampled_primitives(library, drawn)
    ]
    primitives = tuple(one for one in shown if one.flights)
    counted: list[tuple[Kind, InterpolationClaim, int, int]] = []
    for kind in ("trim", "maneuver"):
        claim = next((p.interpolated for k, p in _sampled_primitives(library, drawn) if k == kind), None)
        own = [one for one in primitives if one.kind == kind]
        if claim is None or not own:
            continue
        if max(one.flights for one in own) > claim.flights:
            raise FlightError(
                f"the claim of grown {kind}s is for {claim.flights} flights each, got {len(flights)} flights"
            )
        counted.append((kind, claim, len(own), sum(one.kept for one in own)))
    doubts = adjust_p_values(
        [float(binom.cdf(kept, count, claim.coverage)) for _, claim, count, kept in counted]
    )
    trials = tuple(
        InterpolationTrial(
            kind,
            claim,
            count,
            kept,
            **clopper_pearson_interval(kept, count),
            doubt=doubt,
            refuted=doubt < level,
        )
        for (kind, claim, count, kept), doubt in zip(counted, doubts, strict=True)
    )
    return primitives, trials


def _sampled_primitives(library: Library, drawn: PrimitiveSample) -> list[tuple[Kind, Trim | Maneuver]]:
    trims: list[tuple[Kind, Trim | Maneuver]] = [("trim", library.trim(number)) for number in drawn.trims]
    rows = {row.id: row for row in library.maneuvers}
    return trims + [("maneuver", rows[number]) for number in drawn.maneuvers]
