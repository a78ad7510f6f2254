"""Simulated helicopter with flight loop and log, a `flight.automaton.vehicle.Vehicle`."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.maneuver_end import ManeuverEndDetector, ManeuverStatus
from flight.automaton.vehicle import Leg
from flight.errors import FlightLostError, NoManeuverEndError
from flight.se2 import SE2
from flightlog.attachment_names import INITIAL_STATE_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind
from sim.control.controller import Controller
from sim.control.gains import Gains
from sim.control.maneuver_generator import ManeuverGenerator
from sim.faults.fault_injection import FaultInjector, Parts
from sim.loop.backend import Backend, best_backend
from sim.loop.motion import Motion
from sim.loop.signals import Signals
from sim.loop.specification import CONTROL_PERIOD, CONTROL_RATE, FlightSpecification
from sim.loop.streams import Stream, random_stream
from sim.navigation.navigation import IdealNavigation, Navigation, Navigator
from sim.vehicle.equilibrium import find_equilibrium
from sim.vehicle.helicopter import Helicopter, move_in_plane
from sim.vehicle.parameters import Parameters, read_parameters
from sim.vehicle.uncertainty import DrawnVehicle
from sim.wind.flyable import check_flyable
from sim.wind.weather import Weather

from .flight_header import flight_attachments, flight_header
from .population import sensors_of, vehicle_of
from .recorder import PERIODS_PER_NAVIGATION_SAMPLE, PERIODS_PER_SAMPLE, Recorder
from .supervisor import Supervisor, alarm_limits


class SimulatedHelicopter:
    """Helicopter in simulated air, a `Vehicle`.

    It starts settled in its start trim at the start pose.

    Args:
        specification: specification of the flight.
        library: trims, maneuvers and the maneuver-end rule.
        parameters: vehicle believed; `models/gtmax.toml` if None.
        flown: vehicle flown; drawn by the specification if None.
        gains: gains of the controller.
        backend: numeric back-end; the best available if None. No number depends on it.

    Attributes:
        supervisor: supervisor of the flight; None for unsupervised flights.

    Raises:
        NoManeuverEndError: the library has no maneuver-end rule.
        UnflyableWindError: the vehicle cannot hold the wind.
        FlightLostError: the flight was lost during settling.
    """

    def __init__(
        self,
        specification: FlightSpecification,
        library: Library,
        *,
        parameters: Parameters | None = None,
        flown: DrawnVehicle | None = None,
        gains: Gains | None = None,
        backend: Backend | None = None,
    ) -> None:
        if library.conditions.maneuver_end is None:
            raise NoManeuverEndError(library.name)
        for wind in (specification.wind, *(change.wind for change in specification.wind_changes)):
            check_flyable(wind, library, height=specification.altitude)
        parameters = parameters or read_parameters()
        self._backend = backend = backend or best_backend()
        self._rule = library.conditions.maneuver_end
        self._specification, self._library, self._parameters = specification, library, parameters
        self._trim = library.trim(specification.start_trim)
        self._signals = signals = Signals()
        self._flown = flown = flown or vehicle_of(specification, parameters)
        self._helicopter = Helicopter(
            flown.parameters, step=specification.step, signals=signals, backend=backend, nominal=parameters
        )
        self._steps = round(CONTROL_PERIOD / specification.step)
        self._wind = Weather(specification, parameters, signals, backend)
        self._generator = ManeuverGenerator(
            self._trim.velocity, step=CONTROL_PERIOD, signals=signals, backend=backend
        )
        self._controller = Controller(
            parameters,
            height=specification.altitude,
            step=CONTROL_PERIOD,
            gains=gains,
            adaptive=specification.adaptive,
            signals=signals,
            backend=backend,
        )
        # Parts that run before the plant.
        self._parts: Parts = (self._generator.run, self._controller.run, self._wind.run)
        self._faults: FaultInjector | None = None
        self.supervisor: Supervisor | None = None
        self._periods = 0
        self._timed_out = False
        self._outcome = "completed"
        self._lost: FlightLostError | None = None
        try:
            self._settle()
        except FlightLostError as error:
            self._lost = error
        self._periods = 0
        self._recorder = Recorder(signals, height=specification.altitude)
        self._recorder.add_motion()
        self._initial_state = self._helicopter.state()
        if specification.faults and self._lost is None:
            self._faults = faults = FaultInjector(
                specification.faults,
                signals=signals,
                helicopter=self._helicopter,
                parameters=flown.parameters,
                navigation=self.navigation,
                parts=self._parts,
            )
            self._parts = faults.parts
        if specification.supervised and self._lost is None:
            self.supervisor = Supervisor(
                signals,
                self.navigation,
                height=specification.altitude,
                limits=alarm_limits(library, specification.sensors),
            )

    def _settle(self) -> None:
        """Flies the start trim through its transients.

        Then the world is displaced so that the vehicle is at the start pose.
        """
        specification, target = self._specification, self._trim.velocity
        equilibrium = find_equilibrium(self._parameters, target)
        heading = specification.start.heading - target.yaw_rate * specification.settling_time
        self._helicopter.place(equilibrium, altitude=specification.altitude, heading=heading)
        self.navigation = self._navigator()
        self._recorder = Recorder(self._signals, height=specification.altitude)
        for _ in range(round(specification.settling_time / CONTROL_PERIOD)):
            self._advance()
        displacement = specification.start_pose @ self.truth.pose.inverse()
        self._helicopter.restore(move_in_plane(self._helicopter.state(), displacement))
        self._wind.rotate_world(displacement.heading)
        self._wind.begin()
        self._controller.rotate_world(displacement.heading)
        self.navigation.move_world(displacement)

    def _navigator(self) -> Navigator:
        if self._specification.ideal_navigation:
            return IdealNavigation(self._signals)
        believed, made, installation = sensors_of(self._specification, self._flown)
        return Navigation(
            self.truth,
            errors=believed,
            true_errors=made,
            installation=installation,
            step=CONTROL_PERIOD,
            gravity=self._parameters.environment.gravity,
            rng=random_stream(self._specification.seed, Stream.NAVIGATION),
            signals=self._signals,
            backend=self._backend,
        )

    @property
    def time(self) -> float:
        """Time since the start, seconds."""
        return self._periods / CONTROL_RATE

    @property
    def trim(self) -> int:
        """Id of the trim held now."""
        return self._trim.id

    @property
    def pose(self) -> SE2:
        """Estimated pose in the world."""
        return Motion._make(self._signals.estimate.tolist()).pose

    @property
    def truth(self) -> Motion:
        """True motion, not for decisions."""
        return Motion._make(self._signals.truth.tolist())

    def coast(self, duration: float) -> Leg:
        """Holds the trim for a time in s, or until an alarm.

        The time is rounded to control periods.

        Raises:
            FlightLostError: the vehicle hit the ground or the motion diverged.
        """
        self._note_primitive(PrimitiveKind.COAST, self._trim.id, from_trim=self._trim.id)
        first = self._periods
        with self._attach_track_if_lost(first):
            for _ in range(round(duration / CONTROL_PERIOD)):
                self._advance()
                if self._alarm_since(first):
                    break
        return self._leg(first, settled=True)

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs a maneuver to its end, time-out or first alarm.

        Raises:
            ValueError: the maneuver does not start in the trim held.
            FlightLostError: the vehicle hit the ground or the motion diverged.
        """
        if maneuver.from_trim != self._trim.id:
            raise ValueError(
                f"maneuver {maneuver.id} leaves trim {maneuver.from_trim}; trim {self._trim.id} is held"
            )
        self._trim = self._library.trim(maneuver.to_trim)
        target = self._trim.velocity
        self._generator.set_target(target)
        self._note_primitive(PrimitiveKind.MANEUVER, maneuver.id, from_trim=maneuver.from_trim)
        first, estimate = self._periods, self._signals.estimate
        detector = ManeuverEndDetector(self._rule, to_trim=self._trim.id, target=target, entry_time=self.time)
        status = ManeuverStatus.UNDER_WAY
        with self._attach_track_if_lost(first):
            while status is ManeuverStatus.UNDER_WAY and not self._alarm_since(first):
                self._advance()
                if self._periods % PERIODS_PER_SAMPLE == 0:
                    status = detector.update(self.time, Motion._make(estimate.tolist()).velocity)
        self._timed_out = status is ManeuverStatus.TIMED_OUT
        return self._leg(first, settled=not self._timed_out)

    @contextmanager
    def _attach_track_if_lost(self, first: int) -> Iterator[None]:
        """Adds the track since a control period to a flight loss."""
        try:
            yield
        except FlightLostError as error:
            error.track, _ = self._recorder.tracks(first, self._periods)
            raise

    def _leg(self, first: int, *, settled: bool) -> Leg:
        """Returns the flight from a control period to now."""
        track, estimated_track = self._recorder.tracks(first, self._periods)
        position, heading = self._recorder.standard_deviations(first, self._periods)
        return Leg(
            (self._periods - first) / CONTROL_RATE,
            settled=settled,
            track=track,
            estimated_track=estimated_track,
            standard_deviation=position,
            heading_deviation=heading,
            turbulence=None if self.supervisor is None else self.supervisor.turbulence,
            alarm=self._alarm_since(first),
        )

    def _alarm_since(self, period: int) -> str:
        """Returns the mission's first alarm if raised after a control period."""
        if self.supervisor is None or not self.supervisor.alarms:
            return ""
        alarm = self.supervisor.first_alarm(after=period / CONTROL_RATE)
        return "" if alarm is None else alarm.sentence

    def log(self, attachments: Mapping[str, bytes] | None = None) -> FlightLog:
        """Returns the log of the flight so far.

        Args:
            attachments: further attachments by name, such as mission and plans.
        """
        header = flight_header(
            self._specification, self._parameters, backend=self._backend, outcome=self._outcome
        )
        files = {
            **flight_attachments(self._specification, self._library, self._parameters),
            INITIAL_STATE_ATTACHMENT: json.dumps(asdict(self._initial_state)).encode(),
            **(attachments or {}),
        }
        log = self._recorder.log(header, files)
        log = log if self._faults is None else self._faults.add_to(log)
        return log if self.supervisor is None else self.supervisor.add_to(log)

    def _advance(self) -> None:
        """Flies one control period."""
        if self._lost is not None:
            raise self._lost
        if self._periods % PERIODS_PER_NAVIGATION_SAMPLE == 0:
            self._recorder.add_standard_deviation(self.navigation.standard_deviation())
        if self._faults:
            self._faults.begin()
        for run in self._parts:
            run()
        self._recorder.add_period()
        try:
            self._helicopter.run(self._steps)
        except FlightLostError as error:
            self._outcome = str(error)
            raise
        self._periods += 1
        self.navigation.run()
        self._recorder.add_motion()
        if self._faults:
            self._faults.note()
        if self.supervisor:
            self.supervisor.run()

    def _note_primitive(self, kind: PrimitiveKind, number: int, *, from_trim: int) -> None:
        self._recorder.add_primitive(
            kind=kind, number=number, from_trim=from_trim, to_trim=self._trim, timed_out=self._timed_out
        )
        self._timed_out = False
