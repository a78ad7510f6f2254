"""How many flights a campaign takes, said before the first of them."""

from dataclasses import dataclass

from flight.errors import FlightError
from flight.mission.campaign import Campaign
from identification.statistics.coverage import joint_coverage, samples_needed
from identification.statistics.samples import MANEUVER_SCALARS, TRIM_SCALARS


@dataclass(frozen=True, slots=True)
class CampaignSize:
    """How many flights, and what they may promise when no maneuver fails to settle.

    Attributes:
        bounding: flights that give the bounds.
        nominal: others, that give the values of maneuvers; 0 where the same flights give both.
        confidence: of the coverage.
    """

    bounding: int
    nominal: int
    confidence: float

    @property
    def flights(self) -> int:
        """All flights."""
        return self.bounding + self.nominal

    @property
    def maneuver_support(self) -> int:
        """Numbers fitted to a maneuver's samples."""
        return len(MANEUVER_SCALARS) * (1 if self.nominal else 2)

    def describe(self) -> str:
        """Returns for people what the flights are for and what they promise."""
        claims = [
            joint_coverage(self.bounding, support=support, confidence=self.confidence)
            for support in (len(TRIM_SCALARS), self.maneuver_support)
        ]
        values = f"{self.nominal} others give their values" if self.nominal else "the same give their values"
        return (
            f"{self.bounding} flights give the bounds, {values}: with {self.confidence:.0%} confidence the "
            f"bounds of a trim hold {claims[0]:.1%} of future flights, of a maneuver {claims[1]:.1%}, "
            "all numbers at once"
        )


def campaign_size(
    campaign: Campaign,
    *,
    coverage: float | None,
    confidence: float,
    flights: int | None,
    nominal_flights: int | None,
) -> CampaignSize:
    """Returns how many flights are flown: as many as asked for, as a coverage takes, or the campaign's.

    Args:
        campaign: its own numbers stand in where nothing is asked.
        coverage: share of future flights to be covered, all numbers of a primitive at once.
        confidence: of that share.
        flights: number asked for.
        nominal_flights: number of flights for the values of maneuvers.

    Raises:
        FlightError: coverage or confidence is no share, or both a coverage and a number of flights are given.
    """
    for name, value in (("coverage", coverage), ("confidence", confidence)):
        if value is not None and not 0 < value < 1:
            raise FlightError(f"--{name} must be between 0 and 1, got {value}")
    if coverage is not None and flights is not None:
        raise FlightError("--coverage says how many flights: give it or --flights, not both")
    own_values = campaign.nominal_flights if flights is None else 0
    nominal = own_values if nominal_flights is None else nominal_flights
    if coverage is None:
        return CampaignSize(flights or campaign.flights, nominal, confidence)
    support = CampaignSize(0, nominal, confidence).maneuver_support
    return CampaignSize(samples_needed(coverage, support=support, confidence=confidence), nominal, confidence)
