"""Loads on the helicopter as CasADi expressions.

Used for stepping, trim and linearisation. Body axes forward-right-down at the centre of mass.
Minimum-complexity rotor after Heffley and Mnich (NASA CR 177476) for thrust and inflow, first-order flapping
with stabiliser bar after Mettler, Tischler and Kanade (2000). The main rotor turns clockwise seen from above.
"""

from math import pi
from typing import NamedTuple

import casadi as ca

from .parameters import MainRotor, Parameters, TailRotor

# Keeps the square root differentiable at zero thrust; below any value in flight, m4/s4.
_ROOT_FLOOR = 1e-12
# MIL-style profile power factor of a rotor in forward flight, Heffley and Mnich.
_PROFILE_POWER_GROWTH = 4.6


class Air(NamedTuple):
    """Motion through the air in body axes, gusts included.

    Velocities in m/s, rates in rad/s. Disc, bar and gyro respond to the body's own rates, `roll_rate`,
    `pitch_rate` and `yaw_rate` in rad/s. A gust rate affects the disc through lift only, by an angle of rate
    over rotor speed, which is neglected. `ground_effect` is (R / 4 z)^2 with the rotor's height z above
    ground; 0 out of ground effect.
    """

    u: ca.SX
    v: ca.SX
    w: ca.SX
    p: ca.SX
    q: ca.SX
    r: ca.SX
    roll_rate: ca.SX
    pitch_rate: ca.SX
    yaw_rate: ca.SX
    ground_effect: ca.SX


def still_air(velocity: ca.SX, rates: ca.SX, *, ground_effect: ca.SX | float = 0.0) -> Air:
    """Returns motion through still air from body velocity and rates."""
    u, v, w = ca.vertsplit(velocity)
    p, q, r = ca.vertsplit(rates)
    return Air(u, v, w, p, q, r, roll_rate=p, pitch_rate=q, yaw_rate=r, ground_effect=ca.SX(ground_effect))


def ground_effect_factor(parameters: Parameters, height: ca.SX) -> ca.SX:
    """Returns the ground effect factor of the main rotor.

    (R / 4 z)^2 (Cheeseman and Bennett 1955).

    Args:
        parameters: vehicle.
        height: height of the centre of mass above ground, m; the rotor's height is at least 0.6 radii.
    """
    rotor = parameters.main_rotor
    return (rotor.radius / (4.0 * ca.fmax(height + rotor.hub_height, 0.6 * rotor.radius))) ** 2


class RotorState(NamedTuple):
    """State of actuators and rotors.

    Blade pitch, flapping and gyro in rad, inflow in m/s.
    """

    lateral: ca.SX
    longitudinal: ca.SX
    collective: ca.SX
    pedal: ca.SX
    disc_back: ca.SX
    disc_right: ca.SX
    bar_back: ca.SX
    bar_right: ca.SX
    inflow: ca.SX
    tail_inflow: ca.SX
    gyro: ca.SX


class Flapping(NamedTuple):
    """Steady-state flapping of disc and bar, rad."""

    disc_back: ca.SX
    disc_right: ca.SX
    bar_back: ca.SX
    bar_right: ca.SX


class Loads(NamedTuple):
    """Loads at the centre of mass in body axes, without weight.

    Force in N, moment in N m, shaft power in W.
    """

    force: ca.SX
    moment: ca.SX
    power: ca.SX


def _lift_per_speed(rotor: MainRotor | TailRotor, density: float) -> float:
    """Returns thrust over axial speed at the blades, N s/m."""
    return density * rotor.speed * rotor.radius**2 * rotor.blades * rotor.chord * rotor.lift_slope / 4.0


def _profile_power(rotor: MainRotor | TailRotor, density: float, in_plane_squared: ca.SX) -> ca.SX:
    tip = rotor.speed * rotor.radius
    area = rotor.radius * rotor.blades * rotor.chord
    drag = density * area * rotor.profile_drag / 8.0
    return drag * (tip**2 + _PROFILE_POWER_GROWTH * in_plane_squared) * tip


def _thrust(rotor: MainRotor | TailRotor, density: float, axial_at_blade: ca.SX, inflow: ca.SX) -> ca.SX:
    return _lift_per_speed(rotor, density) * (axial_at_blade - inflow)


def _momentum_inflow(
    rotor: MainRotor | TailRotor,
    density: float,
    *,
    thrust: ca.SX,
    in_plane_squared: ca.SX,
    axial: ca.SX,
    inflow: ca.SX,
) -> ca.SX:
    """Returns the inflow of a thrust by momentum theory (Heffley and Mnich)."""
    half_speed_squared = (in_plane_squared + axial * (axial - 2.0 * inflow)) / 2.0
    hover_squared = thrust / (2.0 * density * pi * rotor.radius**2)
    root = ca.sqrt(half_speed_squared**2 + hover_squared**2) - half_speed_squared
    return ca.sign(thrust) * ca.sqrt(root + _ROOT_FLOOR)


def _main_axial(parameters: Parameters, state: RotorState, air: Air) -> tuple[ca.SX, ca.SX]:
    """Returns axial speeds at the disc and at its blades, m/s."""
    rotor = parameters.main_rotor
    at_disc = air.w + state.disc_back * air.u - state.disc_right * air.v
    return at_disc, at_disc + (2.0 / 3.0) * rotor.speed * rotor.radius * state.collective


def _inflow_in_ground_effect(state: RotorState, air: Air) -> ca.SX:
    """Returns the main rotor's inflow in ground effect, m/s.

    Cheeseman and Bennett (ARC R&M 3021): the image rotor reduces the inflow in hover, and less with speed.
    """
    swept = (air.u**2 + air.v**2) / (state.inflow**2 + _ROOT_FLOOR)
    return state.inflow * (1.0 - air.ground_effect / (1.0 + swept))


def _tail_axial(parameters: Parameters, state: RotorState, air: Air) -> tuple[ca.SX, ca.SX]:
    rotor = parameters.tail_rotor
    at_disc = air.v - rotor.arm * air.r + rotor.height * air.p
    return at_disc, at_disc + (2.0 / 3.0) * rotor.speed * rotor.radius * state.pedal


def inflow_targets(parameters: Parameters, state: RotorState, air: Air) -> tuple[ca.SX, ca.SX]:
    """Returns the inflows of main and tail rotor by momentum theory, m/s."""
    density, main, tail = parameters.environment.air_density, parameters.main_rotor, parameters.tail_rotor
    (main_axial, main_blade), (tail_axial, tail_blade) = (
        _main_axial(parameters, state, air),
        _tail_axial(parameters, state, air),
    )
    main_thrust = _thrust(main, density, main_blade, _inflow_in_ground_effect(state, air))
    tail_thrust = _thrust(tail, density, tail_blade, state.tail_inflow)
    targets = []
    for rotor, thrust, axial, in_plane, inflow in (
        (main, main_thrust, main_axial, air.u**2 + air.v**2, state.inflow),
        (tail, tail_thrust, tail_axial, air.u**2 + air.w**2, state.tail_inflow),
    ):
        targets.append(
            _momentum_inflow(
                rotor, density, thrust=thrust, in_plane_squared=in_plane, axial=axial, inflow=inflow
            )
        )
    return targets[0], targets[1]


def settle_inflow(parameters: Parameters, state: RotorState, air: Air, *, iterations: int) -> RotorState:
    """Iterates the inflow towards balance of blade and momentum theory."""
    for _ in range(iterations):
        main, tail = inflow_targets(parameters, state, air)
        state = state._replace(
            inflow=(state.inflow + main) / 2.0, tail_inflow=(state.tail_inflow + tail) / 2.0
        )
    return state


def flapping_targets(parameters: Parameters, state: RotorState, air: Air) -> Flapping:
    """Returns the steady-state flapping of disc and bar.

    Disc and bar follow as first-order lags. Positive cyclic gives positive flapping: `longitudinal` tilts the
    disc back, `lateral` to the right.
    """
    rotor, bar = parameters.main_rotor, parameters.stabiliser_bar
    tip = rotor.speed * rotor.radius
    back_per_speed = rotor.flap_back * ((8.0 / 3.0) * state.collective - 2.0 * state.inflow / tip) / tip
    return Flapping(
        disc_back=(
            -rotor.flapping_time * air.pitch_rate
            + rotor.coupling_back_from_right * state.disc_right
            + state.longitudinal
            + bar.mixing * state.bar_back
            + back_per_speed * air.u
        ),
        disc_right=(
            -rotor.flapping_time * air.roll_rate
            + rotor.coupling_right_from_back * state.disc_back
            + state.lateral
            + bar.mixing * state.bar_right
            - back_per_speed * air.v
        ),
        bar_back=-bar.time * air.pitch_rate + bar.gain_back * state.longitudinal,
        bar_right=-bar.time * air.roll_rate + bar.gain_right * state.lateral,
    )


def _main_rotor_loads(parameters: Parameters, state: RotorState, air: Air) -> Loads:
    rotor, density = parameters.main_rotor, parameters.environment.air_density
    axial, at_blade = _main_axial(parameters, state, air)
    inflow = _inflow_in_ground_effect(state, air)
    thrust = _thrust(rotor, density, at_blade, inflow)
    power = thrust * (inflow - axial) + _profile_power(rotor, density, air.u**2 + air.v**2)
    # The in-plane wake drag is proportional to the inflow; it was identified in hover.
    weight = parameters.body.mass * parameters.environment.gravity
    hover_inflow = ca.sqrt(weight / (2.0 * density * pi)) / rotor.radius
    fading = parameters.body.mass * state.inflow / hover_inflow
    in_plane_x = -fading * rotor.drag_forward * air.u
    in_plane_y = -fading * rotor.drag_side * air.v
    stiffness = rotor.hub_spring + thrust * rotor.hub_height
    force = ca.vertcat(
        -thrust * state.disc_back + in_plane_x, thrust * state.disc_right + in_plane_y, -thrust
    )
    moment = ca.vertcat(
        stiffness * state.disc_right - rotor.hub_right * thrust,
        stiffness * state.disc_back + rotor.hub_forward * thrust,
        rotor.hub_forward * force[1] - rotor.hub_right * force[0] - power / rotor.speed,
    )
    return Loads(force, moment, power)


def _tail_rotor_loads(parameters: Parameters, state: RotorState, air: Air) -> Loads:
    rotor, density = parameters.tail_rotor, parameters.environment.air_density
    axial, at_blade = _tail_axial(parameters, state, air)
    thrust = _thrust(rotor, density, at_blade, state.tail_inflow)
    power = thrust * (state.tail_inflow - axial) + _profile_power(rotor, density, air.u**2 + air.w**2)
    force = ca.vertcat(0, -thrust, 0)
    moment = ca.vertcat(-thrust * rotor.height, 0, thrust * rotor.arm)
    return Loads(force, moment, power)


def _airframe_loads(parameters: Parameters, state: RotorState, air: Air) -> Loads:
    frame, half_density = parameters.airframe, parameters.environment.air_density / 2.0
    washed = air.w - state.inflow
    side_at_fin = air.v - frame.fin_arm * air.r
    down_at_tail = air.w + frame.tailplane_arm * air.q - frame.tailplane_wash * state.inflow

    def surface(area: float, across: ca.SX) -> ca.SX:
        return -half_density * area * (frame.surface_slope * ca.fabs(air.u) + ca.fabs(across)) * across

    fin, tailplane = surface(frame.fin_area, side_at_fin), surface(frame.tailplane_area, down_at_tail)
    force = ca.vertcat(
        -half_density * frame.plate_front * air.u * ca.fabs(air.u),
        -half_density * frame.plate_side * air.v * ca.fabs(air.v) + fin,
        -half_density * frame.plate_top * washed * ca.fabs(washed) + tailplane,
    )
    moment = ca.vertcat(0, frame.tailplane_arm * tailplane, -frame.fin_arm * fin)
    return Loads(force, moment, ca.SX(0))


def loads(parameters: Parameters, state: RotorState, air: Air) -> Loads:
    """Returns the aerodynamic and shaft loads, without weight."""
    parts = [part(parameters, state, air) for part in (_main_rotor_loads, _tail_rotor_loads, _airframe_loads)]
    return Loads(
        parts[0].force + parts[1].force + parts[2].force,
        parts[0].moment + parts[1].moment + parts[2].moment,
        parts[0].power + parts[1].power,
    )


def inertia(parameters: Parameters) -> ca.DM:
    """Returns the inertia matrix in body axes, in kg m2."""
    body = parameters.body
    matrix = ca.diag(ca.DM([body.inertia_xx, body.inertia_yy, body.inertia_zz]))
    matrix[0, 2] = matrix[2, 0] = -body.inertia_xz
    return matrix
