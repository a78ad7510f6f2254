"""The flight loop: the simulated helicopter as a `flight.vehicle.Vehicle` that keeps its log."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from importlib.metadata import version
from math import cos, sin

import numpy as np

from flight.errors import FlightError, FlightLostError
from flight.library import Library
from flight.library_file import library_text
from flight.log import (
    INITIAL_STATE_ATTACHMENT,
    LIBRARY_ATTACHMENT,
    MODEL_ATTACHMENT,
    SPECIFICATION_ATTACHMENT,
    VEHICLE_ATTACHMENT,
    FlightHeader,
    FlightLog,
    PrimitiveKind,
)
from flight.maneuver import Maneuver
from flight.maneuver_end import ManeuverEndJudge, Verdict
from flight.se2 import SE2
from flight.sequence import Sequence
from flight.vehicle import Leg, Vehicle
from flight.version import VERSION

from .controller import Controller
from .discrete_gust import DiscreteGust
from .equilibrium import EquilibriumFinder
from .helicopter import Helicopter, move_in_plane
from .maneuver_generator import Channel, ManeuverGenerator, Reference
from .motion import Motion
from .navigation import IdealNavigation, Navigation
from .parameters import Parameters, model_hash, model_text, read_parameters
from .recorder import Recorder
from .specification import CONTROL_PERIOD, CONTROL_RATE, FlightSpecification
from .streams import Stream, random_stream
from .wind import DrydenWind, wind_class

BACKEND = f"casadi-vm-{version('casadi')}"
# Motion is logged, and the maneuver-end rule applied, at every second control period; what the vehicle
# believes of its errors is logged at every tenth.
_PERIODS_A_SAMPLE, _PERIODS_A_SPREAD = 2, 10


class NoManeuverEndError(FlightError):
    """A library was to be flown that does not say when a maneuver has ended."""

    def __init__(self, library: Library) -> None:
        super().__init__(
            f"library {library.name!r} cannot be flown: its conditions have no maneuver_end "
            "(a band for each trim, dwell, timeout)"
        )


class SimulatedHelicopter:
    """A helicopter in simulated air that holds trims and performs maneuvers (a `Vehicle`).

    It begins in its start trim, settled, at the start pose.

    Args:
        specification: what is flown, with the seed of all chance.
        library: names the trims and says when a maneuver has ended.
        parameters: the vehicle; that of `models/gtmax.toml` where None.

    Raises:
        NoManeuverEndError: the library does not say when a maneuver has ended.
        FlightLostError: the flight ended before it began.
    """

    def __init__(
        self, specification: FlightSpecification, library: Library, *, parameters: Parameters | None = None
    ) -> None:
        if library.conditions.maneuver_end is None:
            raise NoManeuverEndError(library)
        parameters = parameters or read_parameters()
        self._rule = library.conditions.maneuver_end
        self._specification, self._library, self._parameters = specification, library, parameters
        self._trim = library.trim(specification.start_trim)
        self._target = self._trim.velocity
        self._helicopter = Helicopter(parameters, step=specification.step)
        self._steps = round(CONTROL_PERIOD / specification.step)
        self._wind = DrydenWind(
            wind_class(specification.wind),
            height=specification.altitude,
            span=2.0 * parameters.main_rotor.radius,
            direction=specification.wind_from,
            step=CONTROL_PERIOD,
            rng=random_stream(specification.seed, Stream.WIND),
        )
        self._generator = ManeuverGenerator(self._target, step=CONTROL_PERIOD)
        self._gusts = [DiscreteGust(**dict(gust)) for gust in specification.gusts]
        self._controller = Controller(
            parameters,
            height=specification.altitude,
            step=CONTROL_PERIOD,
            adaptive=specification.adaptive,
        )
        self._recorder = Recorder(height=specification.altitude)
        self._periods = 0
        self._timed_out = False
        self._outcome = "completed"
        self._lost: FlightLostError | None = None
        try:
            self._settle()
        except FlightLostError as error:
            self._lost = error
        self._initial_state = self._helicopter.state()

    def _settle(self) -> None:
        """Flies the start trim until start-up transients are gone, then moves the world to the start pose."""
        specification, target = self._specification, self._target
        equilibrium = EquilibriumFinder(self._parameters).find(target)
        heading = specification.start.heading - target.yaw_rate * specification.settling_time
        self._helicopter.place(equilibrium, altitude=specification.altitude, heading=heading)
        self._truth = self._helicopter.motion()
        self._estimate = self._truth
        self._navigation = (
            IdealNavigation()
            if specification.ideal_navigation
            else Navigation(
                self._truth,
                step=CONTROL_PERIOD,
                gravity=self._parameters.environment.gravity,
                rng=random_stream(specification.seed, Stream.NAVIGATION),
            )
        )
        self._reference = Reference(
            *(Channel(v, 0.0, 0.0) for v in (target.forward, target.side, target.yaw_rate))
        )
        recorder, self._recorder = self._recorder, Recorder(height=specification.altitude)
        for _ in range(round(specification.settling_time / CONTROL_PERIOD)):
            self._advance()
        self._recorder, self._periods = recorder, 0
        displacement = specification.start_pose @ self._truth.pose.inverse()
        self._helicopter.restore(move_in_plane(self._helicopter.state(), displacement))
        self._wind.turn(displacement.heading)
        self._controller.turn(displacement.heading)
        believed = displacement @ self._estimate.pose
        self._estimate = self._estimate._replace(north=believed.x, east=believed.y, heading=believed.heading)
        self._truth = self._helicopter.motion()
        self._navigation.move(displacement, self._truth)

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return self._periods / CONTROL_RATE

    @property
    def trim(self) -> int:
        """Id of the trim held now."""
        return self._trim.id

    @property
    def pose(self) -> SE2:
        """Believed pose in the world."""
        return self._estimate.pose

    @property
    def truth(self) -> Motion:
        """True motion; not for anything that decides."""
        return self._truth

    def coast(self, duration: float) -> Leg:
        """Holds the trim for a time in seconds, to the nearest control period.

        Raises:
            FlightLostError: the flight ended in the ground or diverged.
        """
        self._note_primitive(PrimitiveKind.COAST, self._trim.id, from_trim=self._trim.id)
        start, track = self.time, [self._track_point()]
        with _keeping(track):
            for _ in range(round(duration / CONTROL_PERIOD)):
                self._advance()
                track.append(self._track_point())
        return Leg(self.time - start, settled=True, track=_thin(track))

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs a maneuver to its end, judged on the estimate, or to its time-out.

        Raises:
            ValueError: the maneuver leaves another trim than the one held.
            FlightLostError: the flight ended in the ground or diverged.
        """
        if maneuver.from_trim != self._trim.id:
            raise ValueError(
                f"maneuver {maneuver.id} leaves trim {maneuver.from_trim}; trim {self._trim.id} is held"
            )
        self._trim = self._library.trim(maneuver.to_trim)
        self._target = self._trim.velocity
        self._note_primitive(PrimitiveKind.MANEUVER, maneuver.id, from_trim=maneuver.from_trim)
        start, track = self.time, [self._track_point()]
        judge = ManeuverEndJudge(self._rule, to_trim=self._trim.id, target=self._target, entry_time=start)
        verdict = Verdict.UNDER_WAY
        with _keeping(track):
            while verdict is Verdict.UNDER_WAY:
                self._advance()
                track.append(self._track_point())
                if self._periods % _PERIODS_A_SAMPLE == 0:
                    verdict = judge.judge(self.time, self._estimate.velocity)
        self._timed_out = verdict is Verdict.TIMED_OUT
        return Leg(self.time - start, settled=not self._timed_out, track=_thin(track))

    def log(self, attachments: Mapping[str, bytes] | None = None) -> FlightLog:
        """Returns the log of the flight up to now.

        Args:
            attachments: files to go with it, such as mission and plans, by name.
        """
        specification = self._specification
        self._note_motion()
        header = FlightHeader(
            kind=specification.kind,
            name=specification.name,
            vehicle=self._parameters.name,
            model_hash=model_hash(),
            seed=specification.seed,
            wind=specification.wind,
            code_version=VERSION,
            backend=BACKEND,
            outcome=self._outcome,
        )
        files = {
            SPECIFICATION_ATTACHMENT: specification.to_json(),
            LIBRARY_ATTACHMENT: library_text(self._library).encode(),
            VEHICLE_ATTACHMENT: json.dumps(asdict(self._parameters), indent=1).encode(),
            MODEL_ATTACHMENT: model_text(),
            INITIAL_STATE_ATTACHMENT: json.dumps(asdict(self._initial_state)).encode(),
            **(attachments or {}),
        }
        return self._recorder.log(header, files)

    def _advance(self) -> None:
        """Flies one control period."""
        if self._lost is not None:
            raise self._lost
        if self._periods % _PERIODS_A_SAMPLE == 0:
            self._note_motion()
        if self._periods % _PERIODS_A_SPREAD == 0:
            self._recorder.add_spread(self.time, self._navigation.spread())
        truth = self._truth
        self._reference = self._generator.step(self._target)
        controls = self._controller.step(self._estimate, self._reference)
        c, s = cos(truth.heading), sin(truth.heading)
        wind = self._wind.step(
            velocity_north=c * truth.forward - s * truth.side,
            velocity_east=s * truth.forward + c * truth.side,
        )
        for gust in self._gusts:
            wind = gust.add_to(wind, self.time)
        self._recorder.add_period(
            self.time, controls=controls, servos=self._helicopter.servo_positions(), wind=wind
        )
        try:
            self._helicopter.advance(controls, wind, steps=self._steps)
        except FlightLostError as error:
            self._outcome = str(error)
            raise
        self._periods += 1
        self._truth = self._helicopter.motion()
        self._estimate = self._navigation.step(self._truth)

    def _note_motion(self) -> None:
        self._recorder.add_motion(
            self.time, truth=self._truth, estimate=self._estimate, reference=self._reference
        )

    def _note_primitive(self, kind: PrimitiveKind, number: int, *, from_trim: int) -> None:
        self._note_motion()
        self._recorder.add_primitive(
            self.time,
            kind=kind,
            number=number,
            from_trim=from_trim,
            to_trim=self._trim,
            timed_out=self._timed_out,
        )
        self._timed_out = False

    def _track_point(self) -> tuple[float, float, float, float]:
        truth = self._truth
        return self.time, truth.north, truth.east, truth.heading


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


@contextmanager
def _keeping(track: list[tuple[float, float, float, float]]) -> Iterator[None]:
    """Hands on what was flown of a primitive in which the vehicle is lost."""
    try:
        yield
    except FlightLostError as error:
        error.track = _thin(track)
        raise


def _thin(track: list[tuple[float, float, float, float]]) -> np.ndarray:
    """Keeps every second point and both ends."""
    kept = track[:-1:_PERIODS_A_SAMPLE] + track[-1:]
    return np.array(kept)
