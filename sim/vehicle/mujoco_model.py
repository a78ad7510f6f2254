"""MuJoCo model of the helicopter, a free body."""

from functools import lru_cache

import mujoco

import models

from .parameters import Parameters


def load_model(parameters: Parameters, step: float) -> mujoco.MjModel:
    """Returns the MuJoCo model with the parameters' mass, inertia and gravity.

    Args:
        parameters: vehicle.
        step: plant step, s.
    """
    spec = mujoco.MjSpec.from_file(str(models.FOLDER / "gtmax.xml"))
    body, numbers = spec.body("helicopter"), parameters.body
    body.mass = numbers.mass
    # A half turn about the first axis changes the sign of the product of inertia.
    body.fullinertia = [
        numbers.inertia_xx,
        numbers.inertia_yy,
        numbers.inertia_zz,
        0.0,
        numbers.inertia_xz,
        0.0,
    ]
    spec.option.timestep = step
    spec.option.gravity = [0.0, 0.0, -parameters.environment.gravity]
    return spec.compile()


@lru_cache(maxsize=16)
def shared_model(parameters: Parameters, step: float) -> mujoco.MjModel:
    """Returns the model of a vehicle, shared and unchanged by flights."""
    return load_model(parameters, step)
