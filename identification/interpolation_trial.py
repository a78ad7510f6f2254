"""Test of the coverage claims of interpolated primitives with new flights.

The claim is about a kind: for a share of at least `coverage` of its interpolated primitives, the bounds hold
a number of flights. A drawn primitive passes if each of its new flights, at most as many as claimed, is
inside; if the claim is true, the number that pass is binomial with at least that share.
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
    """Result of new flights for one drawn primitive.

    Attributes:
        kind: trim or maneuver.
        id: id of the trim or maneuver.
        flights: new flights with this primitive, lost and unsettled ones included.
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
        """True if every flight was inside the bounds."""
        return self.inside == self.flights


@dataclass(frozen=True, slots=True)
class InterpolationTrial:
    """Claim of a kind and the result of its drawn primitives.

    Attributes:
        kind: trims or maneuvers.
        claim: coverage claim of the kind.
        drawn: drawn primitives with flights.
        kept: primitives among them with every flight inside the bounds.
        low: lower end of the exact (Clopper-Pearson) 95 % interval of the share kept.
        high: upper end.
        p_value: probability of at most this many kept if the claim is true, after Holm's correction for both
            kinds.
        refuted: True if the p-value is below the level of the test.
    """

    kind: Kind
    claim: InterpolationClaim
    drawn: int
    kept: int
    low: float
    high: float
    p_value: float
    refuted: bool


def interpolation_trials(
    library: Library, drawn: PrimitiveSample, flights: Sequence[FlightEvidence], *, level: float = 0.05
) -> tuple[tuple[PrimitiveTrial, ...], tuple[InterpolationTrial, ...]]:
    """Returns the result of each drawn primitive and a trial per kind.

    Args:
        library: interpolated library.
        drawn: random sample of its primitives.
        flights: new flights, at most as many as the claim covers.
        level: level of the test of both kinds together.

    Raises:
        FlightError: there are more flights than the claim covers.
        InconsistentLogsError: a flight has other trims, maneuvers or another rule.
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
                f"claim of interpolated {kind}s: expected at most {claim.flights} flights each, "
                f"got {len(flights)} flights"
            )
        counted.append((kind, claim, len(own), sum(one.kept for one in own)))
    p_values = adjust_p_values(
        [float(binom.cdf(kept, count, claim.coverage)) for _, claim, count, kept in counted]
    )
    trials = tuple(
        InterpolationTrial(
            kind,
            claim,
            count,
            kept,
            **clopper_pearson_interval(kept, count),
            p_value=p_value,
            refuted=p_value < level,
        )
        for (kind, claim, count, kept), p_value in zip(counted, p_values, strict=True)
    )
    return primitives, trials


def _sampled_primitives(library: Library, drawn: PrimitiveSample) -> list[tuple[Kind, Trim | Maneuver]]:
    trims: list[tuple[Kind, Trim | Maneuver]] = [("trim", library.trim(number)) for number in drawn.trims]
    rows = {row.id: row for row in library.maneuvers}
    return trims + [("maneuver", rows[number]) for number in drawn.maneuvers]
