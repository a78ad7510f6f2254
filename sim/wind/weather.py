"""Air of a flight: winds that fade into each other."""

from sim.loop.backend import Backend
from sim.loop.signals import Signals
from sim.loop.specification import CONTROL_PERIOD, WIND_FADE_TIME, FlightSpecification
from sim.loop.streams import Stream, random_stream
from sim.vehicle.parameters import Parameters

from .wind import DrydenWind
from .wind_class import wind_class


class Weather:
    """Wind of a flight, with its changes.

    Args:
        specification: wind and wind changes.
        parameters: vehicle, for its span.
        signals: output of the wind.
        backend: numeric back-end.

    Attributes:
        run: advances the air by one control period.

    Raises:
        UnknownWindError: a wind class does not exist.
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
        # Control periods since the flight's start; None before it.
        self._period: int | None = None
        for air in self._airs[1:]:
            air.rotate_world(self._airs[0].direction - air.direction)
        self.run = self._change if self._times else self._airs[0].run

    def rotate_world(self, angle: float) -> None:
        """Applies a rotation of the world about the vertical, in rad."""
        for air in self._airs:
            air.rotate_world(angle)

    def begin(self) -> None:
        """Sets time 0, the flight's start."""
        self._period = 0

    def _change(self) -> None:
        """Advances the current wind and fades it into the next.

        Other winds do not advance.
        """
        time, current = 0.0, 0
        if self._period is not None:
            time = self._period * CONTROL_PERIOD
            current = sum(start <= time for start in self._times)
            self._period += 1
        self._airs[current].run()
        if not current or (share := (time - self._times[current - 1]) / WIND_FADE_TIME) >= 1.0:
            return
        new = self._wind.copy()
        self._airs[current - 1].run()
        self._wind[:] = share * new + (1.0 - share) * self._wind
