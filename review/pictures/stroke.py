"""Line styles, shared by lines and their legend entries."""

from dataclasses import dataclass
from typing import Literal

from jaxtyping import Float
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy import ndarray

from . import palette

Dashes = Literal["solid"] | tuple[float, tuple[float, ...]]


@dataclass(frozen=True, slots=True)
class Stroke:
    """Line style: colour, width in points, dashes, opacity, layer (z order)."""

    color: str
    width: float
    dashes: Dashes = "solid"
    opacity: float = 1.0
    layer: float = 4.0

    def draw(self, axes: Axes, x: Float[ndarray, "n"], y: Float[ndarray, "n"]) -> None:
        """Draws a line."""
        axes.add_line(self._line(x, y, ""))
        axes.autoscale_view()

    def entry(self, label: str) -> Line2D:
        """Returns a legend entry of the line."""
        return self._line([], [], label)

    def _line(
        self, x: Float[ndarray, "n"] | list[float], y: Float[ndarray, "n"] | list[float], label: str
    ) -> Line2D:
        return Line2D(
            x,
            y,
            color=self.color,
            linewidth=self.width,
            linestyle=self.dashes,
            alpha=self.opacity,
            zorder=self.layer,
            solid_capstyle="butt",
            label=label,
        )


# In every picture, dashes stand for commanded or planned values.
COMMAND_DASHES = (0.0, (4.0, 2.0))
COMMANDED = Stroke(palette.INK, 1.2, dashes=COMMAND_DASHES, layer=5.0)
ESTIMATED = Stroke(palette.ESTIMATE_COLOR, 1.0, layer=3.0)
ACTUAL = Stroke(palette.TRUE_COLOR, 1.4)
MANEUVER = Stroke(palette.INK, 1.2)
FIRST_PLAN = Stroke(palette.FAINT, 7.0, opacity=0.3, layer=1.0)
LATER_PLAN = Stroke(palette.FAINT, 1.0, opacity=0.45, layer=1.5)
SERVO_COMMAND = Stroke(palette.FAINT, 2.2, layer=3.0)
SERVO = Stroke(palette.TRUE_COLOR, 1.0)
LIMIT = Stroke(palette.ALARM, 1.2)
COMPONENTS = (Stroke(palette.TRUE_COLOR, 1.0), Stroke(palette.ALARM, 1.0), Stroke(palette.FAINT, 1.0))


def trim_stroke(color: str) -> Stroke:
    """Returns the stroke of a coast, in the trim's colour."""
    return Stroke(color, 3.0)
