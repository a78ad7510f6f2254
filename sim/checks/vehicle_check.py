"""Checks of the vehicle: trims, power, ground effect, modes and shape."""

from collections.abc import Iterator

import mujoco
import numpy as np

import models
from flight.se2 import Twist
from flight.units import FOOT
from sim.vehicle.equilibrium import EquilibriumFinder
from sim.vehicle.linearisation import state_matrix
from sim.vehicle.parameters import Parameters

from .check_result import CheckResult

RESIDUAL_LIMIT = 1e-8
_SPEEDS = tuple(float(speed) for speed in range(0, 25, 2))
# Turning trims of the thesis's Table 9 in both directions, in rad/s at 3 and 10 ft/s.
_TURNS = tuple((speed * FOOT, rate) for speed in (3.0, 10.0) for rate in (-0.6, -0.3, 0.3, 0.6))
# Mettler, Tischler and Kanade (2000): name, identified R-50 mode in 1/s, largest relative error.
_FAST_MODES = (
    ("flapping", -20.3 + 4.7j, 0.10),
    ("roll", -2.67 + 11.5j, 0.10),
    ("pitch", -1.70 + 8.19j, 0.10),
    ("yaw with gyro", -6.2 + 8.2j, None),
)
_HEAVE, _HEAVE_LIMIT = -0.61, 0.30
_SLOW = "identified 0.306 +- 0.094i and -0.40 +- 0.09i 1/s"


def check_vehicle(parameters: Parameters) -> Iterator[CheckResult]:
    """Yields trims, power, ground effect, modes and shape."""
    finder = EquilibriumFinder(parameters)
    yield from _check_trims(finder)
    yield from _check_ground(parameters)
    yield from check_modes(parameters)
    yield from check_shape(parameters)


def _check_trims(finder: EquilibriumFinder) -> Iterator[CheckResult]:
    straight = [finder.find(Twist(speed, 0.0, 0.0)) for speed in _SPEEDS]
    turning = [finder.find(Twist(speed, 0.0, rate)) for speed, rate in _TURNS]
    for found in (*straight, *turning):
        velocity = found.velocity
        name = f"residual at {velocity.forward:.4g} m/s, {velocity.yaw_rate:.4g} rad/s"
        attitude = (
            f"roll {np.degrees(found.roll):.1f} deg, pitch {np.degrees(found.pitch):.1f} deg, "
            f"{found.power / 1e3:.2f} kW"
        )
        yield CheckResult("trim", name, finder.residual(found)[0], "-", high=RESIDUAL_LIMIT, beside=attitude)
    power = [found.power for found in straight]
    least = int(np.argmin(power))
    yield CheckResult("power", "hover", power[0], "W", high=15e3, beside="15.4 kW engine")
    yield CheckResult("power", "minimum / hover", power[least] / power[0], "-", high=0.8)
    yield CheckResult("power", "speed of minimum power", _SPEEDS[least], "m/s", low=8.0, high=20.0)
    yield CheckResult("power", "24 m/s / minimum", power[-1] / power[least], "-", low=1.1)


def _check_ground(parameters: Parameters) -> Iterator[CheckResult]:
    """Yields hover power near the ground over that far from it."""
    height = parameters.main_rotor.radius - parameters.main_rotor.hub_height
    hover = Twist(0.0, 0.0, 0.0)
    free = EquilibriumFinder(parameters).find(hover).power
    for name, above, low, high in (
        ("one radius", height, 0.85, 0.97),
        ("ten radii", 10.0 * parameters.main_rotor.radius, 0.995, 1.0),
    ):
        near = EquilibriumFinder(parameters, height=above).find(hover).power
        yield CheckResult(
            "ground", f"hover power, rotor {name} above ground / free air", near / free, "-", low, high
        )


def check_modes(parameters: Parameters) -> Iterator[CheckResult]:
    """Yields the modes of hover beside the identified R-50 modes."""
    hover = EquilibriumFinder(parameters).find(Twist(0.0, 0.0, 0.0))
    modes = np.linalg.eigvals(state_matrix(parameters, hover))
    for name, identified, limit in _FAST_MODES:
        nearest = modes[np.argmin(np.abs(modes - identified))]
        beside = f"identified {identified.real:.3g} +- {identified.imag:.3g}i 1/s"
        for what, value, known in (
            ("frequency", abs(nearest), abs(identified)),
            ("damping", -nearest.real, -identified.real),
        ):
            low, high = (None, None) if limit is None else ((1 - limit) * known, (1 + limit) * known)
            yield CheckResult("modes", f"{name}, {what}", float(value), "1/s", low, high, beside)
    slow = modes[np.abs(modes) < 1.0]
    heave = slow[np.argmin(np.abs(slow - _HEAVE))]
    limits = (1 - _HEAVE_LIMIT) * -_HEAVE, (1 + _HEAVE_LIMIT) * -_HEAVE
    yield CheckResult("modes", "heave", float(-heave.real), "1/s", *limits, beside=f"identified {_HEAVE} 1/s")
    for mode in sorted(slow[(slow.imag > 0.0)], key=lambda value: -value.real):
        yield CheckResult("modes", "slow, growth", float(mode.real), "1/s", beside=_SLOW)
        yield CheckResult("modes", "slow, frequency", float(mode.imag), "1/s", beside=_SLOW)


def check_shape(parameters: Parameters) -> Iterator[CheckResult]:
    """Yields the differences between shape file and parameters."""
    model = mujoco.MjModel.from_xml_path(str(models.FOLDER / "gtmax.xml"))
    body, rotor, tail = parameters.body, parameters.main_rotor, parameters.tail_rotor
    axes = np.zeros(9)
    mujoco.mju_quat2Mat(axes, model.body_iquat[1])
    turn = axes.reshape(3, 3)
    inertia = turn @ np.diag(model.body_inertia[1]) @ turn.T
    # z is up and y left in the shape file, which reverses the sign of the product of inertia.
    expected = np.diag([body.inertia_xx, body.inertia_yy, body.inertia_zz])
    expected[0, 2] = expected[2, 0] = body.inertia_xz
    disc, tail_disc = model.geom("main_rotor"), model.geom("tail_rotor")
    for name, found, stated in (
        ("mass", model.body_mass[1], body.mass),
        ("gravity", -model.opt.gravity[2], parameters.environment.gravity),
        ("rotor radius", disc.size[0], rotor.radius),
        ("blade radius", model.geom("blade").size[0], rotor.radius),
        ("blade chord", 2.0 * model.geom("blade").size[1], rotor.chord),
        ("hub height", model.geom("hub").pos[2], rotor.hub_height),
        ("tail rotor radius", tail_disc.size[0], tail.radius),
        ("tail rotor arm", -tail_disc.pos[0], tail.arm),
        ("tail rotor height", tail_disc.pos[2], tail.height),
        ("tailplane arm", -model.geom("tailplane").pos[0], parameters.airframe.tailplane_arm),
    ):
        yield CheckResult("shape", f"{name}, difference", abs(float(found) - stated), "-", high=1e-9)
    worst = float(np.abs(inertia - expected).max())
    yield CheckResult("shape", "inertia, difference", worst, "kg m2", high=1e-9)
