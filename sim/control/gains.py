"""Gains of the flight controller."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains of the controller in SI units.

    Attributes:
        velocity: acceleration per velocity error, 1/s.
        height: descent per height error, 1/s.
        descent: acceleration per descent error, 1/s.
        model_frequency: frequency of the attitude reference model, rad/s.
        model_damping: damping ratio of the attitude reference model.
        lead: lead of the attitude command over the velocity reference, s.
        attitude: frequencies of the attitude error in roll and pitch, rad/s.
        attitude_damping: damping ratio of the attitude error.
        yaw_rate: yaw acceleration per yaw rate error, 1/s.
        heading: yaw acceleration per heading error, 1/s2.
        heading_error_time: time constant of the heading error's decay, s.
        turn_time: lag of banking for a yaw rate beyond the reference's, s. Equal to the lag of the velocity
            loop, so that the vehicle banks for turns and not for oscillations of the tail.
        tilt_limit: largest attitude command beyond the trim's, rad.
        learning_velocity: learning rate of the horizontal accelerations.
        learning_descent: learning rate of the vertical acceleration.
        learning_attitude: learning rate of roll and pitch.
        learning_yaw: learning rate of yaw.
        forgetting: kappa of the e-modification.
        hedging: 1 with pseudo-control hedging, 0 without.
    """

    velocity: float = 1.5
    height: float = 0.7
    descent: float = 3.0
    model_frequency: float = 7.0
    model_damping: float = 0.8
    lead: float = 0.04
    attitude: tuple[float, float] = (4.0, 3.5)
    attitude_damping: float = 0.4
    yaw_rate: float = 7.0
    heading: float = 25.0
    heading_error_time: float = 60.0
    turn_time: float = 0.67
    tilt_limit: float = 0.45
    learning_velocity: float = 0.6
    learning_descent: float = 1.0
    learning_attitude: float = 6.0
    learning_yaw: float = 3.0
    forgetting: float = 0.05
    hedging: float = 1.0
