"""Adaptive element: single-hidden-layer network for the inversion error.

Laws of Johnson and Kannan (Adaptive Trajectory Control for Autonomous Helicopters, 2005), with
e-modification. The error e = reference - flown obeys e'' = -K_d e' - K_p e + output - model error, which
gives the training signal r = e^T P B.
"""

from typing import NamedTuple

import casadi as ca
import numpy as np
from jaxtyping import Float

HIDDEN = 5
OUTPUTS = 6
"""Accelerations north, east, down in m/s2; angular accelerations in roll, pitch, yaw in rad/s2."""
INPUTS = 9
INNER_WEIGHTS, OUTER_WEIGHTS = INPUTS * HIDDEN, (HIDDEN + 1) * OUTPUTS

# Steepness of the hidden neurons, and learning rate of the inner weights relative to the outer ones.
_STEEPNESS, _INNER_RATE = 1.0, 0.5


class Weights(NamedTuple):
    """Inner weights (inputs, hidden) and outer weights (hidden + 1, outputs)."""

    inner: ca.SX
    outer: ca.SX


def initial_inner_weights() -> Float[np.ndarray, "weights"]:
    """Returns inner weights, column-major, different for every hidden neuron."""
    place = np.arange(INPUTS * HIDDEN).reshape(HIDDEN, INPUTS)
    # A fixed pattern: equal weights would stay equal.
    return np.asarray(0.5 * np.cos(2.4 * place)).ravel()


def network_output(weights: Weights, inputs: ca.SX) -> ca.SX:
    """Returns the network's output, shape (6, 1), for its inputs, (9, 1)."""
    return ca.SX(weights.outer.T @ _hidden_layer(weights, inputs)[0])


def update_weights(
    weights: Weights, inputs: ca.SX, *, training: ca.SX, rates: ca.SX, forgetting: float, step: float
) -> Weights:
    """Returns the weights after one period.

    Args:
        weights: weights before.
        inputs: inputs of the network, shape (9, 1).
        training: r, shape (6, 1), in the units of the outputs times s.
        rates: learning rates of the outputs, shape (6, 1); zeros freeze the network.
        forgetting: kappa of the e-modification.
        step: control period, s.
    """
    hidden, slopes = _hidden_layer(weights, inputs)
    driven = rates * training
    size = ca.sqrt(ca.dot(driven, driven) + 1e-12)
    linear = ca.vertcat(0, slopes * (weights.inner.T @ inputs))
    outer_rate = -(hidden - linear) @ driven.T - forgetting * size * weights.outer
    back = slopes * (weights.outer[1:, :] @ driven)
    inner_rate = -_INNER_RATE * (inputs @ back.T)
    return Weights(weights.inner + step * inner_rate, weights.outer + step * outer_rate)


def _hidden_layer(weights: Weights, inputs: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Returns the bias and hidden values, and the neurons' derivatives."""
    values = 1.0 / (1.0 + ca.exp(-_STEEPNESS * (weights.inner.T @ inputs)))
    return ca.vertcat(1, values), _STEEPNESS * values * (1.0 - values)
