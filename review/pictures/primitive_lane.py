"""Lane of flown primitives, and the matching tint behind panels."""

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from flightlog.log import FlightLog
from flightlog.primitives import FlownPrimitive, PrimitiveKind, merged_primitives
from flightlog.trim_labels import trim_label, trim_names, trim_palette
from review.summary.bound_check import check_bounds

from . import palette

# Width of a letter in the lane, inches.
LETTER = 0.074


def draw_primitive_lane(axes: Axes, log: FlightLog, *, width: float) -> None:
    """Draws flown trims as coloured blocks, maneuvers as gaps with an arrow.

    Args:
        axes: axes of the lane, which share their time axis with the panels below.
        log: the flight.
        width: width of the lane in inches; selects between name, number and no label.
    """
    axes.set_ylim(-0.3, 1)
    axes.set_yticks([])
    axes.spines[:].set_visible(False)
    axes.tick_params(bottom=False, labelbottom=False)
    axes.set_xlim(0.0, log.duration)
    colors, names, left_bounds = trim_palette(log), trim_names(log), _violating_primitives(log)
    for part in merged_primitives(log):
        inches = (part.end - part.start) / log.duration * width
        if part.kind is PrimitiveKind.COAST:
            _block(axes, part, 0.0, colors[part.id])
            _write(axes, part, _longest_fitting_label(part.id, names, inches), "white")
        elif inches > 2 * LETTER:
            _write(axes, part, "\N{RIGHTWARDS ARROW}", palette.INK)
        if (part.kind, part.start) in left_bounds:
            _block(axes, part, -0.3, palette.ALARM)
    title = "Primitives flown: trims, arrows for maneuvers"
    palette.draw_headline(axes, title + ("; underlined: outside the library's bounds" if left_bounds else ""))


def shade_primitives(axes: Axes, log: FlightLog) -> None:
    """Tints a panel by the trim flown; maneuvers stay white."""
    coasts = [part for part in merged_primitives(log) if part.kind is PrimitiveKind.COAST]
    for trim, color in trim_palette(log).items():
        axes.broken_barh(
            [(part.start, part.end - part.start) for part in coasts if part.id == trim],
            (0.0, 1.0),
            transform=axes.get_xaxis_transform(),
            color=color,
            alpha=0.10,
            linewidth=0,
            zorder=0,
        )


def _violating_primitives(log: FlightLog) -> set[tuple[PrimitiveKind, float]]:
    bounds = check_bounds(log)
    return set() if bounds is None else {(violation.kind, violation.start) for violation in bounds.violations}


def _block(axes: Axes, part: FlownPrimitive, bottom: float, color: str) -> None:
    height = 1.0 if bottom == 0.0 else 0.16
    axes.add_patch(Rectangle((part.start, bottom), part.end - part.start, height, color=color, linewidth=0))


def _longest_fitting_label(trim: int, names: dict[int, str], inches: float) -> str:
    label = trim_label(trim, names)
    # The break comes after the number and the first word: `3 fast`, `forward`.
    place = label.find(" ", label.find(" ") + 1)
    two_lines = label if place < 0 else f"{label[:place]}\n{label[place + 1 :]}"
    for text in (label, two_lines, str(trim)):
        if LETTER * max(len(line) for line in text.split("\n")) < inches:
            return text
    return ""


def _write(axes: Axes, part: FlownPrimitive, text: str, color: str) -> None:
    axes.text(
        0.5 * (part.start + part.end),
        0.48,
        text,
        ha="center",
        va="center",
        color=color,
        fontsize=palette.SMALL_TEXT,
        fontweight="bold",
        linespacing=1.0,
    )
