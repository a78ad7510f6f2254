"""Commands of an imported log, and their held levels."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from flightlog.primitives import PrimitiveKind
from flightlog.series import Series
from flightlog.topics import COMMAND_INPUTS, MAX_INPUTS, PRIMITIVE

# A level is held for this long, with changes below this share of the command's range.
_HELD, _SAME = 1.0, 0.01
# Least share of the time at which commands are held for them to be steps.
_MOSTLY = 0.5

Column = Float[np.ndarray, "n"]


def command_series(time: Column, commands: Mapping[str, Column]) -> Series | None:
    """Returns the commands as `/command`; None without any."""
    if not commands:
        return None
    assert len(commands) <= MAX_INPUTS
    values = np.column_stack([*commands.values()])
    known = np.isfinite(values).all(axis=1)
    topic = COMMAND_INPUTS.only(f"input_{number}" for number in range(1, len(commands) + 1))
    return Series(topic, time[known], values[known]) if known.any() else None


def level_series(command: Series, motion: Series) -> tuple[Series, list[str]] | None:
    """Returns held levels as coasts in `/primitive`, and the levels in words.

    A coast begins where its level does; its trim is numbered by level from 1, and its velocity is the median
    over the second half of all that were held at this level. None where commands are not held most of the
    time, or the velocity is not known.

    Args:
        command: commands over time.
        motion: states, of the same clock.
    """
    if not motion.has_fields("forward", "side", "yaw_rate") or len(command) < 2:
        return None
    time, values = command.time, command.values
    spread = np.ptp(values, axis=0)
    same = (np.abs(np.diff(values, axis=0)) <= _SAME * np.where(spread > 0.0, spread, 1.0)).all(axis=1)
    runs = [run for run in np.split(np.arange(len(time)), np.flatnonzero(~same) + 1) if len(run)]
    held = [
        run
        for run in runs
        if time[run[-1]] - time[run[0]] >= _HELD
        and (np.ptp(values[run], axis=0) <= 2.0 * _SAME * spread).all()
    ]
    if sum(time[run[-1]] - time[run[0]] for run in held) < _MOSTLY * (time[-1] - time[0]):
        return None
    means = [np.median(values[run], axis=0) for run in held]
    levels: list[Column] = []
    numbers = []
    for mean in means:
        near = [
            place
            for place, level in enumerate(levels)
            if (np.abs(mean - level) <= _SAME * spread + 1e-9).all()
        ]
        if not near:
            levels.append(mean)
        numbers.append(near[0] + 1 if near else len(levels))
    velocities = {}
    for number in set(numbers):
        inside = np.zeros(len(motion.time), bool)
        for run, each in zip(held, numbers, strict=True):
            if each == number:
                half = 0.5 * (time[run[0]] + time[run[-1]])
                inside |= (motion.time >= half) & (motion.time <= time[run[-1]])
        columns = [motion[name][inside] for name in ("forward", "side", "yaw_rate")]
        finite = np.isfinite(np.column_stack(columns)).all(axis=1)
        if not finite.any():
            return None
        velocities[number] = [float(np.median(column[finite])) for column in columns]
    rows = [
        [float(PrimitiveKind.COAST), number, number, number, *velocities[number], 0.0] for number in numbers
    ]
    words = [
        f"{number}: {', '.join(f'{value:.4g}' for value in level)}"
        for number, level in enumerate(levels, start=1)
    ]
    return Series(PRIMITIVE, time[[run[0] for run in held]], np.array(rows, np.float64)), words
