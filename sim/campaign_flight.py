"""The flights of a campaign: each a walk through its automaton, each a log that says whose it is."""

from dataclasses import dataclass, field
from pathlib import Path

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg, Vehicle
from flight.errors import BadFileError, FlightLostError
from flight.mission.sequence import Sequence
from flightlog.channels import PRIMITIVE, TRUTH
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.identity import flight_identity, identity_difference
from flightlog.log import FlightLog
from runtime.code_version import code_version
from runtime.job import JobResult, JobState, JobStatus, check_code_version
from sim.loop.backend import Backend
from sim.loop.specification import FlightSpecification
from sim.vehicle.parameters import Parameters, read_parameters

from .flight_header import flight_attachments, flight_header
from .simulated_helicopter import SimulatedHelicopter


@dataclass(frozen=True, slots=True)
class CampaignFlightResult:
    """What became of one flight of a campaign.

    Attributes:
        specification: what was to be flown.
        path: its log.
        outcome: `completed`, or what went wrong.
        timeouts: maneuvers that ended by time-out.
        duration: simulated time in s.
    """

    specification: FlightSpecification
    path: Path
    outcome: str
    timeouts: int
    duration: float


def fly_sequence(vehicle: Vehicle, sequence: Sequence, *, library: Library) -> tuple[Leg, ...]:
    """Flies a sequence of trims, joined by the library's maneuvers.

    Args:
        vehicle: holds the first trim of the sequence.
        sequence: trims and coasting times.
        library: holds the maneuvers that join them.

    Returns:
        Coasts and maneuvers in turn.

    Raises:
        NoManeuverError: two trims follow one another that no maneuver joins.
        FlightLostError: the flight ended in the ground or diverged.
    """
    maneuvers = library.maneuvers_along(sequence.trims)
    legs = [vehicle.coast(sequence.coasting_times[0])]
    for maneuver, coasting_time in zip(maneuvers, sequence.coasting_times[1:], strict=True):
        legs.append(vehicle.perform(maneuver))
        legs.append(vehicle.coast(coasting_time))
    return tuple(legs)


def fly_specification(
    specification: FlightSpecification,
    library: Library,
    *,
    parameters: Parameters | None = None,
    backend: Backend | None = None,
) -> FlightLog:
    """Flies the sequence of a specification; a lost flight gives its log up to there.

    Args:
        specification: what is flown.
        library: flown with.
        parameters: the vehicle; that of `models/gtmax.toml` where None.
        backend: what evaluates expressions; the best that there is where None.
    """
    helicopter = SimulatedHelicopter(specification, library, parameters=parameters, backend=backend)
    try:
        fly_sequence(helicopter, specification.sequence, library=library)
    except FlightLostError:
        # The log says so: its header carries the outcome.
        return helicopter.log()
    return helicopter.log()


@dataclass(frozen=True, slots=True)
class CampaignFlight:
    """One flight of a campaign, and the log that keeps it (a `runtime.job.Job`).

    Attributes:
        specification: what is to be flown.
        library: flown with.
        path: of the log.
        code: version that flies it.
    """

    specification: FlightSpecification
    library: Library
    path: Path
    code: str = field(default_factory=code_version)

    def status(self) -> JobStatus[CampaignFlightResult]:
        """Returns what its log says, if it is there, whole, and of this very flight."""
        if not self.path.exists():
            return JobStatus(JobState.MISSING)
        try:
            log = read_log(self.path, topics=(PRIMITIVE, TRUTH))
        except BadFileError as error:
            return JobStatus(JobState.DAMAGED, reason=str(error))
        wrong = identity_difference(self._identity(), flight_identity(log.header, log.attachments))
        if wrong is not None:
            return JobStatus(JobState.ANOTHER, reason=f"{self.path} is of another flight: {wrong}")
        return JobStatus(JobState.WHOLE, self._result(log))

    def run(self) -> JobResult[CampaignFlightResult]:
        """Flies.

        Raises:
            OtherCodeError: this process has other code than the one that asked.
        """
        check_code_version(self.code, code_version())
        log = fly_specification(self.specification, self.library)
        return JobResult(((self.path, log_bytes(log)),), self._result(log))

    def _result(self, log: FlightLog) -> CampaignFlightResult:
        timeouts = int(log[PRIMITIVE]["timed_out"].sum()) if PRIMITIVE.name in log.series else 0
        return CampaignFlightResult(self.specification, self.path, log.header.outcome, timeouts, log.duration)

    def _identity(self) -> dict[str, str]:
        parameters = read_parameters()
        header = flight_header(self.specification, parameters, backend=Backend.INTERPRETED)
        return flight_identity(header, flight_attachments(self.specification, self.library, parameters))
