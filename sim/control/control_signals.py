"""Inputs, outputs and state of the control law, in column order."""

from typing import NamedTuple

import casadi as ca

from . import adaptive_element as element


class InversionModel(NamedTuple):
    """Inversion model: the vehicle linearised in hover.

    Attributes:
        roll: angular acceleration per disc angle to the right, 1/s2.
        pitch: angular acceleration per disc angle back, 1/s2.
        yaw: angular acceleration per pedal, 1/s2.
        yaw_from_collective: angular acceleration per collective, 1/s2.
        lift: upward acceleration per collective, m/s2.
    """

    roll: float
    pitch: float
    yaw: float
    yaw_from_collective: float
    lift: float


class ControllerState(NamedTuple):
    """State of the controller.

    Reference model, predicted bar and servos, integrated heading error in rad, filtered yaw rate beyond the
    reference's in rad/s (`excess_yaw`), weights.
    """

    roll: ca.SX
    roll_rate: ca.SX
    pitch: ca.SX
    pitch_rate: ca.SX
    bar_back: ca.SX
    bar_right: ca.SX
    heading_error: ca.SX
    excess_yaw: ca.SX
    servos: ca.SX
    inner_weights: ca.SX
    outer_weights: ca.SX


STATE_SIZES = (1, 1, 1, 1, 1, 1, 1, 1, 4, element.INNER_WEIGHTS, element.OUTER_WEIGHTS)
"""Number of entries of each part, in order."""


class ControlReference(NamedTuple):
    """Reference of each channel with derivatives, and the trim there."""

    forward: ca.SX
    forward_rate: ca.SX
    forward_acceleration: ca.SX
    side: ca.SX
    side_rate: ca.SX
    side_acceleration: ca.SX
    yaw: ca.SX
    yaw_rate: ca.SX
    yaw_acceleration: ca.SX
    trim_roll: ca.SX
    trim_pitch: ca.SX
    trim_lateral: ca.SX
    trim_longitudinal: ca.SX
    trim_collective: ca.SX
    trim_pedal: ca.SX


def split_state(state: ca.SX) -> ControllerState:
    """Returns the parts of a state column."""
    places = [0]
    for size in STATE_SIZES:
        places.append(places[-1] + size)
    return ControllerState._make(ca.vertsplit(state, places))
