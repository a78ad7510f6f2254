"""Visual model for films: turning rotors, 10 m ground grid, sky, light.

Built from the vehicle's shape in the log; the flight dynamics do not use it.
"""

from collections.abc import Sequence

import mujoco

import models
from flight.errors import BadFileError
from flightlog.attachment_names import MODEL_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.viewers.mjcf_check import parse_model

MAIN_ROTOR, TAIL_ROTOR = ("blade", "main_rotor", "stabiliser_bar"), ("tail_blade", "tail_rotor")
"""Geoms that turn about the vertical and the sideward axis, in the order of their angles.

The first of each is at the rotor's centre."""

_VEHICLE = "helicopter"
# Spacing of the ground's grid, m.
_GRID = 10.0
_SKY, _HAZE = (0.36, 0.56, 0.80), (0.84, 0.90, 0.95)


def film_model(log: FlightLog) -> mujoco.MjModel:
    """Builds the model to render: a free body and its rotor angles.

    Raises:
        BadFileError: the log's shape cannot be read.
    """
    text = log.attachments.get(MODEL_ATTACHMENT)
    if text is None:
        text = (models.FOLDER / "gtmax.xml").read_bytes()
    parse_model(text, MODEL_ATTACHMENT)
    try:
        spec = mujoco.MjSpec.from_string(text.decode())
        shape = spec.compile()
    except (ValueError, UnicodeDecodeError) as error:
        why = " ".join(str(error).split())
        raise BadFileError(MODEL_ATTACHMENT, f"expected a drawable model: {why}") from None
    for names, axis in ((MAIN_ROTOR, (0.0, 0.0, 1.0)), (TAIL_ROTOR, (0.0, 1.0, 0.0))):
        _add_rotor_joint(spec, shape, names, axis)
    _add_ground(spec)
    _add_lights(spec)
    return spec.compile()


def _add_rotor_joint(
    spec: mujoco.MjSpec, shape: mujoco.MjModel, names: Sequence[str], axis: tuple[float, float, float]
) -> None:
    """Moves geoms to a hinged body centred at the first geom."""
    geoms = [spec.geom(name) for name in names]
    vehicle = spec.body(_VEHICLE)
    if vehicle is None or None in geoms:
        return
    middle = shape.geom(names[0]).pos
    rotor = vehicle.add_body(name=f"turning_{names[0]}", pos=middle, mass=1e-6, inertia=[1e-6] * 3)
    rotor.explicitinertial = True
    rotor.add_joint(name=names[0], type=mujoco.mjtJoint.mjJNT_HINGE, axis=axis)
    for geom in geoms:
        made = shape.geom(geom.name)
        rotor.add_geom(
            type=int(made.type[0]),
            size=made.size,
            pos=made.pos - middle,
            quat=made.quat,
            material=geom.material,
            contype=0,
            conaffinity=0,
            mass=0.0,
        )
        spec.delete(geom)


def _add_ground(spec: mujoco.MjSpec) -> None:
    """Adds an infinite ground plane with a grid."""
    for geom in [geom for geom in spec.geoms if geom.type == mujoco.mjtGeom.mjGEOM_PLANE]:
        spec.delete(geom)
    spec.add_texture(
        name="film_ground",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_CHECKER,
        mark=mujoco.mjtMark.mjMARK_EDGE,
        rgb1=(0.40, 0.53, 0.34),
        rgb2=(0.44, 0.57, 0.37),
        markrgb=(0.62, 0.72, 0.54),
        width=512,
        height=512,
    )
    # One texture covers two squares in each direction.
    repeats = [0.5 / _GRID] * 2
    textures = [""] * mujoco.mjtTextureRole.mjNTEXROLE
    textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "film_ground"
    spec.add_material(name="film_ground", textures=textures, texrepeat=repeats, texuniform=True)
    spec.worldbody.add_geom(
        name="film_ground",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0.0, 0.0, 1.0],
        material="film_ground",
        contype=0,
        conaffinity=0,
    )


def _add_lights(spec: mujoco.MjSpec) -> None:
    """Adds sun, sky and haze."""
    for texture in [each for each in spec.textures if each.type == mujoco.mjtTexture.mjTEXTURE_SKYBOX]:
        texture.rgb1, texture.rgb2 = _HAZE, _SKY
    for light in list(spec.lights):
        spec.delete(light)
    spec.worldbody.add_light(
        name="sun",
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL,
        pos=[0.0, 0.0, 200.0],
        dir=[0.30, -0.45, -0.84],
        diffuse=[0.75, 0.72, 0.66],
        specular=[0.25, 0.25, 0.25],
        castshadow=False,
    )
    visual = spec.visual
    visual.headlight.ambient, visual.headlight.diffuse = [0.38, 0.40, 0.44], [0.22, 0.22, 0.22]
    visual.headlight.specular = [0.05, 0.05, 0.05]
    visual.rgba.haze = [*_HAZE, 1.0]
    # These are in units of the model's extent, which is set to 1 m.
    spec.stat.extent = 1.0
    visual.map.znear, visual.map.zfar, visual.map.haze = 0.05, 1500.0, 0.25
    visual.quality.offsamples = 4
