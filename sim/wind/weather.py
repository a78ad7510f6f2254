"""The air of a flight: one wind, or several of which one fades into the next."""

from sim.loop.backend import Backend
from sim.loop.signals import Signals
from sim.loop.specification import CONTROL_PERIOD, WIND_FADE_TIME, FlightSpecification
from sim.loop.streams import Stream, random_stream
from sim.vehicle.parameters import Parameters

from .wind import DrydenWind, wind_class


class Weather:
    """Moves the air of a flight.

    Args:
        specification: the wind, and what changes it.
        parameters: the vehicle, whose breadth counts.
        signals: where the air's motion is left.
        backend: what evaluates gusts.

    Attributes:
        run: moves the air on by one control period.

    Raises:
        UnknownWindError: there is no such wind.
    """

    def __init__(
        self, specification: FlightSpecification, parameters: Parameters, signals: Signals, backend: Backend
    ) -> None:
        names = [specification.wind, *(change.wind for change in specification.wind_changes)]
        self._airs = [
            DrydenWind(
                wind_class(name),
                height=specification.altitude,
                span=2.0 * parameters.main_rotor.radius,
                direction=specification.wind_from,
                step=CONTROL_PERIOD,
                rng=random_stream(specification.seed, Stream.WIND, number),
                signals=signals,
                backend=backend,
            )
            for number, name in enumerate(names)
        ]
        self._times = [change.time for change in specification.wind_changes]
        self._wind = signals.wind
        # Counts from the flight's start, which is not yet.
        self._period: int | None = None
        for air in self._airs[1:]:
            air.rotate_world(self._airs[0].direction - air.direction)
        self.run = self._change if self._times else self._airs[0].run

    def rotate_world(self, angle: float) -> None:
        """Follows a turn of the whole world about the vertical, in rad."""
        for air in self._airs:
            air.rotate_world(angle)

    def begin(self) -> None:
        """Takes now for the flight's start."""
        self._period = 0

    def _change(self) -> None:
        """Moves on the air that blows, and fades it into the next; what does not blow stands still."""
        time, come = 0.0, 0
        if self._period is not None:
            time = self._period * CONTROL_PERIOD
            come = sum(start <= time for start in self._times)
            self._period += 1
        self._airs[come].run()
        if not come or (share := (time - self._times[come - 1]) / WIND_FADE_TIME) >= 1.0:
            return
        new = self._wind.copy()
        self._airs[come - 1].run()
        self._wind[:] = share * new + (1.0 - share) * self._wind
