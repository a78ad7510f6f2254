"""Number of flights of a campaign for a coverage."""

from dataclasses import dataclass

from flight.errors import FlightError
from flight.mission.campaign import Campaign
from identification.statistics.coverage import joint_coverage, samples_needed
from identification.statistics.samples import MANEUVER_SCALARS, TRIM_SCALARS


@dataclass(frozen=True, slots=True)
class CampaignSize:
    """Numbers of flights and their coverage if every maneuver settles.

    Attributes:
        bounding: flights for the bounds.
        nominal: other flights for the values of maneuvers; 0 where the same flights give both.
        confidence: confidence of the coverage.
    """

    bounding: int
    nominal: int
    confidence: float

    @property
    def flights(self) -> int:
        """Total number of flights."""
        return self.bounding + self.nominal

    @property
    def maneuver_support(self) -> int:
        """Number of values fitted to a maneuver's samples."""
        return len(MANEUVER_SCALARS) * (1 if self.nominal else 2)

    def describe(self) -> str:
        """Returns the numbers of flights and their coverage in one sentence."""
        claims = [
            joint_coverage(self.bounding, support=support, confidence=self.confidence)
            for support in (len(TRIM_SCALARS), self.maneuver_support)
        ]
        values = f"{self.nominal} others for the values" if self.nominal else "values from the same flights"
        return (
            f"{self.bounding} flights for the bounds, {values}: the bounds of a trim cover {claims[0]:.1%} "
            f"of future flights, of a maneuver {claims[1]:.1%}, all numbers at once "
            f"({self.confidence:.0%} confidence)"
        )


def campaign_size(
    campaign: Campaign,
    *,
    coverage: float | None,
    confidence: float,
    flights: int | None,
    nominal_flights: int | None,
) -> CampaignSize:
    """Returns the number of flights: requested, for a coverage, or default.

    Args:
        campaign: campaign with the default numbers.
        coverage: share of future flights to cover, all numbers of a primitive at once.
        confidence: confidence of that share.
        flights: requested number of flights.
        nominal_flights: requested number of flights for the values of maneuvers.

    Raises:
        FlightError: coverage or confidence is not between 0 and 1, or both coverage and flights are given.
    """
    for name, value in (("coverage", coverage), ("confidence", confidence)):
        if value is not None and not 0 < value < 1:
            raise FlightError(f"--{name} must be between 0 and 1, got {value}")
    if coverage is not None and flights is not None:
        raise FlightError("--coverage and --flights: expected one of them, got both")
    own_values = campaign.nominal_flights if flights is None else 0
    nominal = own_values if nominal_flights is None else nominal_flights
    if coverage is None:
        return CampaignSize(flights or campaign.flights, nominal, confidence)
    support = CampaignSize(0, nominal, confidence).maneuver_support
    return CampaignSize(samples_needed(coverage, support=support, confidence=confidence), nominal, confidence)
