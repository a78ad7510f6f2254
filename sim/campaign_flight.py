"""Flights of a campaign as jobs, each with its log."""

from dataclasses import dataclass, field
from pathlib import Path

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg, Vehicle
from flight.errors import BadFileError, FlightLostError
from flight.mission.sequence import Sequence
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.identity.flight_identity import flight_identity, identity_difference
from flightlog.log import FlightLog
from flightlog.topics import PRIMITIVE, TRUTH
from runtime.code_version import code_version
from runtime.job import JobResult, JobState, JobStatus, check_code_version
from sim.loop.backend import Backend
from sim.loop.specification import FlightSpecification
from sim.vehicle.parameters import Parameters, read_parameters

from .flight_header import flight_attachments, flight_header
from .simulated_helicopter import SimulatedHelicopter


@dataclass(frozen=True, slots=True)
class CampaignFlightResult:
    """Result of one flight of a campaign.

    Attributes:
        specification: specification of the flight.
        path: path of its log.
        outcome: `completed`, or the reason of the failure.
        timeouts: maneuvers that ended by time-out.
        duration: simulated time, s.
    """

    specification: FlightSpecification
    path: Path
    outcome: str
    timeouts: int
    duration: float


def fly_sequence(vehicle: Vehicle, sequence: Sequence, *, library: Library) -> tuple[Leg, ...]:
    """Flies a sequence of trims, joined by the library's maneuvers.

    Args:
        vehicle: vehicle, in the first trim of the sequence.
        sequence: trims and coasting times.
        library: library with the maneuvers.

    Returns:
        Coasts and maneuvers alternately.

    Raises:
        NoManeuverError: no maneuver joins two consecutive trims.
        FlightLostError: the vehicle hit the ground or the motion diverged.
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
    """Flies a specified sequence; a lost flight gives a partial log.

    Args:
        specification: specification of the flight.
        library: library flown with.
        parameters: vehicle; `models/gtmax.toml` if None.
        backend: numeric back-end; the best available if None.
    """
    helicopter = SimulatedHelicopter(specification, library, parameters=parameters, backend=backend)
    try:
        fly_sequence(helicopter, specification.sequence, library=library)
    except FlightLostError:
        # The outcome is in the log's header.
        return helicopter.log()
    return helicopter.log()


@dataclass(frozen=True, slots=True)
class CampaignFlight:
    """One flight of a campaign, a `runtime.job.Job`.

    Attributes:
        specification: specification of the flight.
        library: library flown with.
        path: path of the log.
        code: required code version.
    """

    specification: FlightSpecification
    library: Library
    path: Path
    code: str = field(default_factory=code_version)

    def status(self) -> JobStatus[CampaignFlightResult]:
        """Returns the status of its log."""
        if not self.path.exists():
            return JobStatus(JobState.MISSING)
        try:
            log = read_log(self.path, topics=(PRIMITIVE, TRUTH))
        except BadFileError as error:
            return JobStatus(JobState.DAMAGED, reason=str(error))
        difference = identity_difference(self._identity(), flight_identity(log.header, log.attachments))
        if difference is not None:
            return JobStatus(JobState.ANOTHER, reason=f"{self.path} is of another flight: {difference}")
        return JobStatus(JobState.WHOLE, self._result(log))

    def run(self) -> JobResult[CampaignFlightResult]:
        """Flies and returns log and result.

        Raises:
            CodeMismatchError: this process has another code version than requested.
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
