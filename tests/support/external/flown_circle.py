"""Circle in closed form, for files of other programs, and its comparison with a log.

Radius 20 m, 4 m/s, clockwise from north, heading along the track, height 10 m, 20 s at 50 Hz.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

from flightlog.series import Series

TIME = 0.02 * np.arange(1000)
RATE, SPEED, RADIUS, HEIGHT = 0.2, 4.0, 20.0, 10.0

Column = Float[np.ndarray, "n"]


def table() -> dict[str, Column]:
    """Returns the columns of a table of the circle."""
    turned = RATE * TIME
    return {
        "time": TIME,
        "x": RADIUS * np.sin(turned),
        "y": RADIUS * (1.0 - np.cos(turned)),
        "z": np.full(len(TIME), -HEIGHT),
        "vx": SPEED * np.cos(turned),
        "vy": SPEED * np.sin(turned),
        "vz": np.zeros(len(TIME)),
        "yaw": turned,
    }


def text(columns: Mapping[str, Column], *, separator: str = ",", ending: str = "") -> str:
    """Returns the text of a table, with an ending of each row of numbers."""
    rows = [separator.join(columns)]
    rows += [
        separator.join(f"{value:.9f}" for value in row) + ending
        for row in zip(*(column.tolist() for column in columns.values()), strict=True)
    ]
    return "\n".join(rows) + "\n"


def check_circle(
    states: Series, *, fields: Sequence[str] = (), atol: float = 1e-6, start: float = 0.0
) -> None:
    """Asserts that states are those of the circle, where they are known.

    Args:
        states: states of an imported log.
        fields: fields to compare; all that can be if empty.
        atol: largest difference.
        start: time of the first state on the circle, seconds.
    """
    turned = RATE * (states.time + start)
    expected = {
        "north": RADIUS * np.sin(turned),
        "east": RADIUS * (1.0 - np.cos(turned)),
        "down": np.full(len(turned), -HEIGHT),
        "forward": np.full(len(turned), SPEED),
        "side": np.zeros(len(turned)),
        "descent": np.zeros(len(turned)),
        "yaw_rate": np.full(len(turned), RATE),
        "heading": turned,
    }
    for name in fields or expected:
        error = states[name] - expected[name]
        if name == "heading":
            error = np.remainder(error + np.pi, 2 * np.pi) - np.pi
        known = error[np.isfinite(error)]
        assert len(known), name
        np.testing.assert_allclose(
            known, 0.0, atol=max(atol, 1e-4) if name == "yaw_rate" else atol, err_msg=name
        )
