"""Velocity response of vehicle and controller with ideal sensors."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from jaxtyping import Float

from flight.errors import FlightLostError
from flight.se2 import Twist
from sim.control.controller import Controller
from sim.control.gains import Gains
from sim.control.maneuver_generator import ManeuverGenerator
from sim.loop.motion import Motion
from sim.vehicle.equilibrium import find_equilibrium
from sim.vehicle.helicopter import DEFAULT_STEP, Helicopter
from sim.vehicle.parameters import Parameters
from sim.wind.wind import DrydenWind
from sim.wind.wind_class import wind_class

_STEP = 0.01
_HEIGHT = 30.0


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """Response, one row every 10 ms.

    Attributes:
        motion: columns as in `Motion`.
        reference: forward, side (m/s), yaw rate (rad/s).
        servos: servo positions, rad, columns as in `Controls`.
        lost: whether the flight was lost.
        controller: controller after the flight.
    """

    motion: Float[np.ndarray, "n 13"]
    reference: Float[np.ndarray, "n 3"]
    servos: Float[np.ndarray, "n 4"]
    lost: bool
    controller: Controller

    def column(self, name: str) -> Float[np.ndarray, "n"]:
        """Returns a column of the motion by its name."""
        return np.asarray(self.motion[:, Motion._fields.index(name)])

    @property
    def velocity_error(self) -> float:
        """Root mean square velocity error over all axes, m/s."""
        flown = np.stack([self.column(name) for name in ("forward", "side", "descent")], axis=1)
        wanted = np.column_stack([self.reference[:, :2], np.zeros(len(flown))])
        return float(np.sqrt(((wanted - flown) ** 2).sum(axis=1).mean()))


def simulate_response(
    targets: Sequence[tuple[Twist, float]],
    *,
    vehicle: Parameters,
    controller_model: Parameters | None = None,
    gains: Gains | None = None,
    adaptive: bool = True,
    wind: str = "calm",
    seed: int = 1,
    skip: int = 0,
    plant_step: float = DEFAULT_STEP,
) -> Response:
    """Flies a list of velocities, the first held from the start.

    Args:
        targets: velocities and their durations, s.
        vehicle: vehicle flown.
        controller_model: vehicle that the controller is designed for, whose equilibrium is the start; the
            flown one if None.
        gains: gains of the controller.
        adaptive: whether the adaptive element learns.
        wind: wind class.
        seed: seed of the wind.
        skip: rows dropped at the start.
        plant_step: plant step, s, a divisor of 10 ms.
    """
    controller_model, start = controller_model or vehicle, targets[0][0]
    helicopter = Helicopter(vehicle, step=plant_step)
    helicopter.place(find_equilibrium(controller_model, start), altitude=_HEIGHT, heading=1.0)
    controller = Controller(controller_model, height=_HEIGHT, step=_STEP, gains=gains, adaptive=adaptive)
    generator = ManeuverGenerator(start, step=_STEP)
    air = DrydenWind(
        wind_class(wind),
        height=_HEIGHT,
        span=2.0 * vehicle.main_rotor.radius,
        direction=pi / 3.0,
        step=_STEP,
        rng=np.random.default_rng(seed),
    )
    rows, lost = [], False
    steps = round(_STEP / helicopter.step_length)
    for target in (target for target, seconds in targets for _ in range(round(seconds / _STEP))):
        motion, reference = helicopter.motion(), generator.step(target)
        wanted = (reference.forward.value, reference.side.value, reference.yaw_rate.value)
        rows.append((*motion, *wanted, *helicopter.servo_positions()))
        c, s = cos(motion.heading), sin(motion.heading)
        wind_now = air.step(
            velocity_north=c * motion.forward - s * motion.side,
            velocity_east=s * motion.forward + c * motion.side,
        )
        try:
            helicopter.advance(controller.step(motion, reference), wind_now, steps=steps)
        except FlightLostError:
            lost = True
            break
    motions, references, servos = np.split(np.array(rows[skip:]), (len(Motion._fields), -4), axis=1)
    return Response(motions, references, servos, lost, controller)
