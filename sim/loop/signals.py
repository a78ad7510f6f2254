"""What the parts of the flight loop say to one another: the numbers of one moment, side by side in memory.

Every part reads some of these arrays and writes others, so that nothing is copied between them, and one copy
of all is what a log keeps.
"""

from itertools import accumulate

import numpy as np

from .motion import Controls, Motion, Reference, ReferenceChannel, Wind

_MOTION = (len(Motion._fields), len(Motion._fields), len(Reference._fields) * len(ReferenceChannel._fields))
_PERIOD = (len(Controls._fields), len(Controls._fields), len(Wind._fields))


class Signals:
    """The numbers of one moment; arrays of doubles that share one memory.

    Attributes:
        truth: true motion, laid out as `Motion`.
        estimate: what the vehicle believes, likewise.
        reference: value, rate and acceleration of the channels of `Reference`.
        controls: servo commands, laid out as `Controls`.
        servos: where the servos are, likewise.
        wind: motion of the air, laid out as `Wind`.
        motion: truth, estimate and reference in one: what is so at a moment.
        period: controls, servos and wind in one: what is held over the period that begins then.
    """

    __slots__ = (
        *("truth", "estimate", "reference", "controls", "servos", "wind"),
        *("motion", "period"),
    )

    def __init__(self) -> None:
        self.motion, self.period = np.zeros(sum(_MOTION)), np.zeros(sum(_PERIOD))
        self.truth, self.estimate, self.reference = np.split(self.motion, [*accumulate(_MOTION)][:-1])
        self.controls, self.servos, self.wind = np.split(self.period, [*accumulate(_PERIOD)][:-1])
