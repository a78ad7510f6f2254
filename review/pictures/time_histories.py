"""Time histories: commanded, estimated and actual values, tinted by primitive."""

from collections.abc import Mapping, Sequence
from math import degrees

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind, merged_primitives
from flightlog.topics import ACTUATORS, COMMAND, CONTROLS, ESTIMATE, MOTION, NAVIGATION, TRUTH, WIND
from flightlog.trim_labels import trim_palette
from review.summary.bound_check import bounding_library
from review.summary.tracking import navigation_error

from . import palette, stroke
from .primitive_lane import shade_primitives

DEGREES_PER_RADIAN = degrees(1.0)

TITLES = {
    "forward": "Forward speed, m/s",
    "side": "Sideward speed, m/s (right positive)",
    "yaw_rate": "Yaw rate, deg/s (right turn positive)",
    "roll": "Roll, deg (right side down positive)",
    "pitch": "Pitch, deg (nose up positive)",
    "collective": "Collective pitch, deg",
    "longitudinal": "Longitudinal cyclic pitch, deg (nose up positive)",
    "lateral": "Lateral cyclic pitch, deg (right positive)",
    "pedal": "Tail rotor pitch, deg",
}


def draw_velocity(axes: Axes, log: FlightLog, field: str) -> None:
    """Draws one velocity: commanded, estimated, actual, with the trims' bounds.

    Args:
        axes: axes to draw on.
        log: the flight.
        field: `forward`, `side` or `yaw_rate`.
    """
    scale = _scale(field)
    _draw_bounds(axes, log, field)
    _draw_state(axes, log, field, scale)
    if COMMAND.name in log.series and log[COMMAND].has_fields(field):
        stroke.COMMANDED.draw(axes, log[COMMAND].time, scale * log[COMMAND][field])
    _finish(axes, log, TITLES[field], least_span=0.5 * scale**0.5)


def draw_height(axes: Axes, log: FlightLog) -> None:
    """Draws the height: commanded, estimated, actual.

    The heights of an imported log are above its own origin.
    """
    _draw_state(axes, log, "down", -1.0)
    if COMMAND.name in log.series and log[COMMAND].has_fields("height"):
        stroke.COMMANDED.draw(axes, log[COMMAND].time, log[COMMAND]["height"])
    above = "the log's origin" if log.header.kind == "import" else "ground"
    _finish(axes, log, f"Height above {above}, m", least_span=2.0)


def draw_attitude(axes: Axes, log: FlightLog, field: str) -> None:
    """Draws roll or pitch as estimated and actual."""
    _draw_state(axes, log, field, DEGREES_PER_RADIAN)
    _finish(axes, log, TITLES[field], least_span=2.0)
    palette.draw_legend_above(axes, _state_entries(log))


def draw_control(axes: Axes, log: FlightLog, field: str, limits: Mapping[str, tuple[float, float]]) -> None:
    """Draws a control's command, servo position and known limits.

    Args:
        axes: axes to draw on.
        log: the flight.
        field: `collective`, `longitudinal`, `lateral` or `pedal`.
        limits: lower and upper limit in radians, by field.
    """
    controls = log[CONTROLS]
    stroke.SERVO_COMMAND.draw(axes, controls.time, DEGREES_PER_RADIAN * controls[f"{field}_command"])
    stroke.SERVO.draw(axes, controls.time, DEGREES_PER_RADIAN * controls[field])
    shown = [DEGREES_PER_RADIAN * limit for limit in limits.get(field, ())]
    known = f", limits {shown[0]:.1f} and {shown[1]:.1f}" if shown else ""
    _finish(axes, log, TITLES[field] + known, least_span=2.0)
    span = axes.get_ylim()
    for limit in shown:
        stroke.LIMIT.draw(axes, np.array([0.0, log.duration]), np.full(2, limit))
    # A distant limit is stated in the title and must not flatten the curve.
    axes.set_ylim(span)
    palette.draw_legend_above(
        axes, [stroke.SERVO_COMMAND.entry("servo command"), stroke.SERVO.entry("servo")]
    )


def draw_actuators(axes: Axes, log: FlightLog, fields: Sequence[str]) -> None:
    """Draws up to three numbered controls."""
    controls = log[ACTUATORS]
    for field, style in zip(fields, stroke.COMPONENTS, strict=False):
        style.draw(axes, controls.time, controls[field])
    numbers = ", ".join(field.removeprefix("control_") for field in fields)
    _finish(axes, log, f"Control{'s' if len(fields) > 1 else ''} {numbers}, as logged")
    _name_components(axes, fields)


def draw_wind(axes: Axes, log: FlightLog, fields: Sequence[str], title: str) -> None:
    """Draws up to three components of the air's motion at the vehicle."""
    wind = log[WIND]
    fields = [field for field in fields if wind.has_fields(field)]
    for field, style in zip(fields, stroke.COMPONENTS, strict=False):
        style.draw(axes, wind.time, _scale(field) * wind[field])
    _finish(axes, log, title)
    _name_components(axes, fields)


def draw_navigation_error(axes: Axes, log: FlightLog, field: str, title: str) -> None:
    """Draws estimate minus truth of a state field, with three sigma."""
    scale = _scale(field)
    stroke.ACTUAL.draw(axes, log[TRUTH].time, scale * navigation_error(log, field))
    if NAVIGATION.name in log.series:
        sigma = log[NAVIGATION]
        edge = 3.0 * scale * sigma[field]
        axes.fill_between(sigma.time, -edge, edge, color=palette.FAINT, alpha=0.25, linewidth=0, zorder=1)
        entry = Patch(facecolor=palette.FAINT, alpha=0.4, label="estimated three sigma")
        palette.draw_legend_above(axes, [entry])
    axes.axhline(0.0, color=palette.FAINT, linewidth=0.8, zorder=2)
    _finish(axes, log, title)


def stroke_legend(log: FlightLog) -> list[Line2D | Patch]:
    """Returns the legend of the panels' strokes that the log has."""
    entries: list[Line2D | Patch] = [*_state_entries(log)]
    if COMMAND.name in log.series:
        entries.insert(0, stroke.COMMANDED.entry("commanded"))
    if bounding_library(log) is not None:
        bound = "trim \N{PLUS-MINUS SIGN} error in the library"
        entries.append(Patch(facecolor=palette.FAINT, alpha=0.4, label=bound))
    return entries


def _state_entries(log: FlightLog) -> list[Line2D]:
    estimated = [stroke.ESTIMATED.entry("estimated")]
    actual = [stroke.ACTUAL.entry("actual")]
    return [
        *(estimated if ESTIMATE.name in log.series else []),
        *(actual if log.motion.topic.name != ESTIMATE.name else []),
    ]


def _draw_state(axes: Axes, log: FlightLog, field: str, scale: float) -> None:
    drawn = {topic.name: stroke.ACTUAL for topic in (TRUTH, MOTION)} | {ESTIMATE.name: stroke.ESTIMATED}
    for name in (ESTIMATE.name, TRUTH.name, MOTION.name):
        if name in log.series and log.series[name].has_fields(field):
            drawn[name].draw(axes, log.series[name].time, scale * log.series[name][field])


def _draw_bounds(axes: Axes, log: FlightLog, field: str) -> None:
    library = bounding_library(log)
    if library is None:
        return
    colors, scale = trim_palette(log), _scale(field)
    for part in merged_primitives(log):
        if part.kind is PrimitiveKind.COAST:
            trim = library.trim(part.id)
            nominal, error = getattr(trim.velocity, field), abs(getattr(trim.error, field))
            axes.fill_between(
                [part.start, part.end],
                scale * (nominal - error),
                scale * (nominal + error),
                color=colors[part.id],
                alpha=0.25,
                linewidth=0,
                zorder=1,
            )


def _finish(axes: Axes, log: FlightLog, title: str, *, least_span: float = 0.0) -> None:
    palette.format_axes(axes)
    palette.draw_headline(axes, title)
    shade_primitives(axes, log)
    axes.set_xlim(0.0, log.duration or 1.0)
    low, high = axes.get_ylim()
    if high - low < least_span:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least_span, middle + 0.5 * least_span)


def _name_components(axes: Axes, fields: Sequence[str]) -> None:
    if len(fields) == 1:
        return
    entries = [
        style.entry(field.replace("_", " ")) for field, style in zip(fields, stroke.COMPONENTS, strict=False)
    ]
    palette.draw_legend_above(axes, entries)


def _scale(field: str) -> float:
    """Returns the factor from a field's unit to the unit shown."""
    angular = field in {"roll", "pitch", "heading"} or "rate" in field.split("_")
    return DEGREES_PER_RADIAN if angular else 1.0
