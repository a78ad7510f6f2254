"""The gains of the flight controller, feedback and learning."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains of the controller; every one in SI.

    Attributes:
        velocity: acceleration per velocity error, 1/s.
        height: descent per height error, 1/s.
        descent: acceleration per descent error, 1/s.
        model_frequency: of the attitude's reference model, rad/s.
        model_damping: of the same.
        lead: time that the attitude command runs ahead of the velocity's reference, s.
        attitude: frequencies of the attitude error in roll and pitch, rad/s.
        attitude_damping: of the same.
        yaw_rate: yaw acceleration per yaw rate error, 1/s.
        heading: yaw acceleration per heading error, 1/s2.
        heading_error_time: time after which a heading error is forgotten, s.
        turn_time: lag with which a yaw rate past the reference's is believed to be a turn, s. As long as the
            velocity loop's own, so that the vehicle banks into a turn and not into a swing of its tail.
        tilt_limit: largest attitude command away from the trim's, rad.
        learning_velocity: learning rate of the horizontal accelerations.
        learning_descent: of the vertical one.
        learning_attitude: of roll and pitch.
        learning_yaw: of yaw.
        forgetting: kappa of the e-modification.
        hedging: 1, or 0 to let the element see the servos' limits.
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
