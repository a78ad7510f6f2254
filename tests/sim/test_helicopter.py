"""Tests of the free body in MuJoCo: frames, limits and lost flights."""

from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

import models
from flight.errors import BadFileError, FlightLostError
from flight.se2 import SE2, Twist
from sim.loop.motion import STILL_AIR, Controls, Wind
from sim.vehicle.equilibrium import EquilibriumFinder
from sim.vehicle.helicopter import Helicopter, move_in_plane
from sim.vehicle.parameters import model_hash, read_parameters

PARAMETERS = read_parameters()
FINDER = EquilibriumFinder(PARAMETERS)


def flying(velocity: Twist, *, heading: float = 0.3, step: float = 0.005) -> tuple[Helicopter, Controls]:
    trim = FINDER.find(velocity)
    helicopter = Helicopter(PARAMETERS, step=step)
    helicopter.place(trim, altitude=30.0, heading=heading)
    return helicopter, trim.controls


def test_mass_and_inertia_of_the_shape_file_are_those_of_the_parameters() -> None:
    model = mujoco.MjModel.from_xml_path(str(models.FOLDER / "gtmax.xml"))
    body = PARAMETERS.body
    assert model.body_mass[1] == body.mass
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, model.body_iquat[1])
    axes = rotation.reshape(3, 3)
    inertia = axes @ np.diag(model.body_inertia[1]) @ axes.T
    # z is up and y left in the shape file, which reverses the sign of the product of inertia.
    expected = np.array(
        [
            [body.inertia_xx, 0, body.inertia_xz],
            [0, body.inertia_yy, 0],
            [body.inertia_xz, 0, body.inertia_zz],
        ]
    )
    np.testing.assert_allclose(inertia, expected, atol=1e-12)
    assert model.opt.gravity.tolist() == [0.0, 0.0, -PARAMETERS.environment.gravity]
    assert (model.nbody, model.nq) == (2, 7)


def test_the_engine_neither_restarts_nor_adds_forces_of_its_own() -> None:
    model = mujoco.MjModel.from_xml_path(str(models.FOLDER / "gtmax.xml"))
    for flag in (mujoco.mjtDisableBit.mjDSBL_AUTORESET, mujoco.mjtDisableBit.mjDSBL_CONTACT):
        assert model.opt.disableflags & flag
    assert model.opt.density == 0.0
    assert model.opt.viscosity == 0.0
    assert (model.geom_contype == 0).all()


@pytest.mark.parametrize("yaw_rate", [0.0, 0.6, -0.6])
def test_trim_controls_hold_the_trim_for_two_seconds(yaw_rate: float) -> None:
    helicopter, controls = flying(Twist(3.0, 0.0, yaw_rate))
    helicopter.advance(controls, STILL_AIR, steps=400)
    motion = helicopter.motion()
    expected = SE2(0.0, 0.0, 0.3) @ SE2.exp(Twist(3.0, 0.0, yaw_rate), 2.0)
    assert motion.pose.distance_to(expected.position) < 0.02
    assert motion.heading == pytest.approx(expected.heading, abs=0.002)
    assert motion.down == pytest.approx(-30.0, abs=0.01)


def test_flying_with_the_wind_is_flying_in_still_air() -> None:
    helicopter, controls = flying(Twist(3.0, 0.0, 0.0), heading=0.0)
    helicopter.advance(controls, STILL_AIR, steps=200)
    still = helicopter.motion()
    helicopter, controls = flying(Twist(3.0, 0.0, 0.0), heading=0.0)
    state = helicopter.state()
    drifting = replace(state, velocity=(state.velocity[0] + 1.0, state.velocity[1] - 2.0, state.velocity[2]))
    helicopter.restore(drifting)
    helicopter.advance(controls, Wind(1.0, -2.0, 0.0, 0.0, 0.0, 0.0), steps=200)
    carried = helicopter.motion()
    assert carried.north - still.north == pytest.approx(1.0, abs=1e-9)
    assert carried.east - still.east == pytest.approx(-2.0, abs=1e-9)
    assert carried.roll == pytest.approx(still.roll, abs=1e-9)


@pytest.mark.parametrize(
    ("control", "rate"), [("lateral", "roll_rate"), ("longitudinal", "pitch_rate"), ("pedal", "yaw_rate")]
)
def test_positive_controls_turn_the_positive_way(control: str, rate: str) -> None:
    helicopter, controls = flying(Twist(0.0, 0.0, 0.0))
    moved = controls._replace(**{control: getattr(controls, control) + 0.02})
    helicopter.advance(moved, STILL_AIR, steps=60)
    assert getattr(helicopter.motion(), rate) > 0.05


def test_more_collective_climbs() -> None:
    helicopter, controls = flying(Twist(0.0, 0.0, 0.0))
    helicopter.advance(controls._replace(collective=controls.collective + 0.02), STILL_AIR, steps=100)
    assert helicopter.motion().descent < -0.3


def test_a_restored_state_flies_on_to_the_same_bytes() -> None:
    helicopter, controls = flying(Twist(3.0, 0.0, 0.6))
    helicopter.advance(controls, STILL_AIR, steps=101)
    other = Helicopter(PARAMETERS)
    other.restore(helicopter.state())
    for vehicle in (helicopter, other):
        vehicle.advance(controls, Wind(2.0, 1.0, 0.5, 0.1, 0.0, 0.1), steps=50)
    assert other.motion() == helicopter.motion()


def test_moving_the_world_changes_nothing_but_the_place() -> None:
    helicopter, _ = flying(Twist(3.0, 0.0, 0.6))
    before = helicopter.motion()
    displacement = SE2(4.0, -2.0, 1.1)
    helicopter.restore(move_in_plane(helicopter.state(), displacement))
    after = helicopter.motion()
    expected = displacement @ before.pose
    assert after.pose.distance_to(expected.position) < 1e-12
    np.testing.assert_allclose(after[3:8] + after[9:], before[3:8] + before[9:], atol=1e-12)


def test_the_step_does_not_matter_much() -> None:
    ends = []
    for step in (0.005, 0.000625):
        helicopter, controls = flying(Twist(2.0, 0.0, 0.3), step=step)
        # Half a second of cyclic against the trim: the rotor's modes are well excited.
        helicopter.advance(
            controls._replace(lateral=controls.lateral + 0.01), STILL_AIR, steps=round(0.5 / step)
        )
        helicopter.advance(controls, STILL_AIR, steps=round(1.5 / step))
        ends.append(helicopter.motion())
    assert ends[0].pose.distance_to(ends[1].pose.position) < 0.01


def test_a_diverged_flight_is_lost_and_never_restarts() -> None:
    helicopter, controls = flying(Twist(0.0, 0.0, 0.0))
    with pytest.raises(FlightLostError, match=r"flight lost at .* s: the motion diverged"):
        helicopter.advance(controls, Wind(np.nan, 0.0, 0.0, 0.0, 0.0, 0.0), steps=10)
    assert np.isnan(helicopter.state().velocity).any()


def test_the_ground_ends_a_flight() -> None:
    helicopter, controls = flying(Twist(0.0, 0.0, 0.0))
    with pytest.raises(FlightLostError, match="the helicopter met the ground"):
        helicopter.advance(controls._replace(collective=0.0), STILL_AIR, steps=2000)
    assert helicopter.motion().down > -1.0


def test_servos_keep_their_rate_and_travel() -> None:
    helicopter, controls = flying(Twist(0.0, 0.0, 0.0))
    before = helicopter.servo_positions()
    moved = controls._replace(lateral=9.0, pedal=-9.0)
    helicopter.advance(moved, STILL_AIR, steps=round(PARAMETERS.servos.delay / 0.005))
    assert helicopter.servo_positions().lateral == pytest.approx(before.lateral, abs=1e-12)
    helicopter.advance(moved, STILL_AIR, steps=2)
    after = helicopter.servo_positions()
    assert after.lateral - before.lateral == pytest.approx(0.01 * PARAMETERS.servos.rate)
    assert before.pedal - after.pedal == pytest.approx(0.01 * PARAMETERS.servos.pedal_rate)
    helicopter.advance(controls._replace(lateral=9.0), STILL_AIR, steps=30)
    assert helicopter.servo_positions().lateral == PARAMETERS.servos.cyclic_limit


def test_an_impossible_vehicle_is_refused_by_name(tmp_path: Path) -> None:
    text = (models.FOLDER / "gtmax.toml").read_text()
    path = tmp_path / "heavy.toml"
    path.write_text(text.replace("mass = 78.0", "mass = -78.0"))
    with pytest.raises(BadFileError, match=r"heavy.toml: body.mass"):
        read_parameters(path)
    path.write_text(text.replace("mass = 78.0", "weight = 78.0"))
    with pytest.raises(BadFileError, match=r"heavy.toml: body"):
        read_parameters(path)


def test_the_model_hash_is_one_of_a_kind() -> None:
    assert len(model_hash()) == 64
