"""Sensors as they are built into one airframe."""

from dataclasses import dataclass
from math import sin

import numpy as np
from jaxtyping import Float

from .sensor_errors import SensorErrors

# Terms of the deviation: sine and cosine of the heading, and of twice the heading.
DEVIATIONS = 4
SIZE = 3 + 3 + DEVIATIONS + 3 + 2
"""Numbers of an installation."""


@dataclass(frozen=True, slots=True)
class Installation:
    """Errors of an airframe's sensors that stay as built.

    Attributes:
        scale: scale factor errors of the gyros.
        misalignment: rotation of the inertial unit about the body axes, rad.
        deviation: factors of sine and cosine of the heading, and of twice the heading, rad.
        antenna: position from the true centre of mass, m.
        vibration: amplitude of the accelerometers' vibration, mean over a period, m/s2.
        phase_step: phase of the vibration in a period, rad.
    """

    scale: tuple[float, ...]
    misalignment: tuple[float, ...]
    deviation: tuple[float, ...]
    antenna: tuple[float, ...]
    vibration: float
    phase_step: float

    def values(self) -> Float[np.ndarray, "15"]:
        """Returns the numbers in the order of the attributes."""
        parts = (*self.scale, *self.misalignment, *self.deviation, *self.antenna)
        return np.array([*parts, self.vibration, self.phase_step])


def draw_installation(
    errors: SensorErrors,
    rng: np.random.Generator,
    *,
    step: float,
    blade_frequency: float,
    centre_of_mass: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Installation:
    """Draws how the sensors of a class are built in.

    Args:
        errors: class of the sensors.
        rng: generator of the airframe.
        step: control period, s.
        blade_frequency: of the passing blades, rad/s.
        centre_of_mass: place of the true centre of mass from the nominal one, m.
    """
    scale, misalignment = errors.gyro_scale * rng.standard_normal(3), rng.standard_normal(3)
    deviation = errors.heading_deviation * rng.standard_normal(DEVIATIONS)
    half = blade_frequency * step / 2.0
    return Installation(
        tuple(scale.tolist()),
        tuple((errors.misalignment * misalignment).tolist()),
        tuple(deviation.tolist()),
        tuple(place - moved for place, moved in zip(errors.antenna, centre_of_mass, strict=True)),
        # The mean of a sine over a period.
        errors.vibration * sin(half) / half if half else 0.0,
        blade_frequency * step,
    )
