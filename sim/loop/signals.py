"""Signals of the flight loop in shared memory.

Every part of the loop reads some of these arrays and writes others, without copies; the recorder copies them
all.
"""

from itertools import accumulate

import numpy as np

from .motion import Controls, Motion, Reference, ReferenceChannel, Wind

_MOTION = (len(Motion._fields), len(Motion._fields), len(Reference._fields) * len(ReferenceChannel._fields))
_PERIOD = (len(Controls._fields), len(Controls._fields), len(Wind._fields))


class Signals:
    """Signals of one period; arrays of doubles in one memory.

    Attributes:
        truth: true motion, laid out as `Motion`.
        estimate: estimated motion, laid out as `Motion`.
        reference: value, rate and acceleration of the channels of `Reference`.
        controls: servo commands, laid out as `Controls`.
        servos: servo positions, laid out as `Controls`.
        wind: motion of the air, laid out as `Wind`.
        motion: truth, estimate and reference in one array, at one instant.
        period: controls, servos and wind in one array, held over a control period.
    """

    __slots__ = (
        *("truth", "estimate", "reference", "controls", "servos", "wind"),
        *("motion", "period"),
    )

    def __init__(self) -> None:
        self.motion, self.period = np.zeros(sum(_MOTION)), np.zeros(sum(_PERIOD))
        self.truth, self.estimate, self.reference = np.split(self.motion, [*accumulate(_MOTION)][:-1])
        self.controls, self.servos, self.wind = np.split(self.period, [*accumulate(_PERIOD)][:-1])
