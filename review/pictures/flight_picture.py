"""Pictures of a flight, one file each; `flight.png` is the overview."""

import io
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from flightlog.log import FlightLog
from flightlog.primitives import merged_primitives
from flightlog.topics import ACTUATORS, CONTROLS, ESTIMATE, TRUTH, WIND
from review.summary.tracking import VELOCITIES
from runtime.atomic_write import file_target, write_atomically

from . import palette
from .primitive_lane import draw_primitive_lane
from .time_histories import (
    draw_actuators,
    draw_attitude,
    draw_control,
    draw_height,
    draw_navigation_error,
    draw_velocity,
    draw_wind,
    stroke_legend,
)
from .track_picture import draw_track

Panel = Callable[[Axes], None]
Limits = Mapping[str, tuple[float, float]]

# Width in inches of a page of time histories, so that a long flight stays readable.
NARROWEST, WIDEST, INCHES_PER_SECOND = 12.0, 36.0, 0.11


def flight_picture(log: FlightLog) -> Figure:
    """Returns the overview page: plan view, velocities and height."""
    figure = palette.new_figure(16.0, 9.6)
    figure.suptitle(_headline(log), x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 4, fontweight="bold")
    halves = figure.add_gridspec(1, 2, width_ratios=(0.43, 0.57))
    left, right = figure.add_subfigure(halves[0]), figure.add_subfigure(halves[1])
    track = left.subplots()
    true = log.motion.topic.name != ESTIMATE.name
    palette.draw_headline(track, f"{'True' if true else 'Estimated'} track, from above")
    _stack(right, log, _motion_panels(log), width=8.6)
    draw_track(track, log)
    return figure


def track_picture(log: FlightLog) -> Figure:
    """Returns the plan view alone, large."""
    figure = palette.new_figure(10.0, 10.6)
    figure.suptitle(_headline(log), x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 3, fontweight="bold")
    draw_track(figure.subplots(), log)
    return figure


def velocities_picture(log: FlightLog) -> Figure:
    """Returns velocities and height over time."""
    return _histories(log, _motion_panels(log))


def controls_picture(log: FlightLog, *, limits: Limits | None = None) -> Figure:
    """Returns attitude and controls over time.

    Args:
        log: the flight.
        limits: known lower and upper limits of the controls in radians, by field.
    """
    panels: list[Panel] = [partial(draw_attitude, log=log, field=field) for field in _angles(log)]
    if CONTROLS.name in log.series:
        panels += [_control_panel(log, field, limits or {}) for field in _CONTROLS]
    if ACTUATORS.name in log.series:
        names = log[ACTUATORS].topic.field_names
        panels += [
            partial(draw_actuators, log=log, fields=names[at : at + 3]) for at in range(0, len(names), 3)
        ]
    return _histories(log, panels, strokes=False)


def wind_picture(log: FlightLog) -> Figure:
    """Returns the air's motion at the vehicle over time.

    Raises:
        MissingTopicError: the log has no wind.
    """
    velocity, rotation = ("north", "east", "down"), ("rate_north", "rate_east", "rate_down")
    panels: list[Panel] = [
        lambda axes: draw_wind(axes, log, velocity, "Air over the ground at the vehicle, m/s")
    ]
    if log[WIND].has_fields(*rotation):
        title = "Rotation of the air about the world's axes, deg/s"
        panels.append(lambda axes: draw_wind(axes, log, rotation, title))
    return _histories(log, panels, strokes=False)


def navigation_picture(log: FlightLog) -> Figure:
    """Returns the navigation errors, estimate minus truth, over time.

    Raises:
        MissingTopicError: the log has no estimate.
    """
    parts = (
        ("north", "Estimated minus actual position north, m"),
        ("east", "Estimated minus actual position east, m"),
        ("down", "Estimated minus actual position down, m"),
        ("forward", "Estimated minus actual forward speed, m/s"),
        ("side", "Estimated minus actual sideward speed, m/s"),
        ("heading", "Estimated minus actual heading, deg"),
    )
    return _histories(log, [_navigation_panel(log, *part) for part in parts], strokes=False)


def write_pictures(
    log: FlightLog, folder: Path, *, limits: Limits | None = None, force: bool = False
) -> tuple[Path, ...]:
    """Writes every picture that the log has topics for, as PNG.

    Args:
        log: the flight.
        folder: output folder; created if missing.
        limits: limits of the controls, as in `controls_picture`.
        force: overwrite.

    Returns:
        The files, the overview first.

    Raises:
        AlreadyExistsError: one of the files exists and `force` is not set; nothing is written.
        FlightError: the log lacks motion, or an attachment is broken.
    """
    pictures = _pictures(log, limits)
    paths = picture_paths(log, folder)
    for path in paths:
        file_target(path, force=force)
    for path, draw in zip(paths, pictures.values(), strict=True):
        write_picture(draw(), path, force=force)
    return paths


def picture_paths(log: FlightLog, folder: Path) -> tuple[Path, ...]:
    """Returns the files that `write_pictures` writes, in its order."""
    return tuple(folder / f"{name}.png" for name in _pictures(log, None))


def _pictures(log: FlightLog, limits: Limits | None) -> dict[str, Callable[[], Figure]]:
    pictures: dict[str, Callable[[], Figure]] = {}
    if log.motion.has_fields("north", "east"):
        pictures["flight"] = lambda: flight_picture(log)
        pictures["track"] = lambda: track_picture(log)
    if _motion_panels(log):
        pictures["velocities"] = lambda: velocities_picture(log)
    if _angles(log) or {CONTROLS.name, ACTUATORS.name} & log.series.keys():
        pictures["attitude_and_controls"] = lambda: controls_picture(log, limits=limits)
    if WIND.name in log.series:
        pictures["wind"] = lambda: wind_picture(log)
    if {ESTIMATE.name, TRUTH.name} <= log.series.keys():
        pictures["navigation_error"] = lambda: navigation_picture(log)
    return pictures


def write_picture(figure: Figure, path: Path, *, force: bool = False) -> None:
    """Writes a figure as a PNG file atomically; output is deterministic.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
    """
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    write_atomically(stream.getvalue(), path, force=force)


_CONTROLS = ("collective", "longitudinal", "lateral", "pedal")


def _headline(log: FlightLog) -> str:
    header = log.header
    flown = [] if header.kind == "import" else [f"wind {header.wind}", f"seed {header.seed}"]
    facts = [f"{header.vehicle}", *flown, f"{log.duration:.1f} s"]
    if header.outcome != "completed":
        facts.append(header.outcome)
    return f"{header.kind.capitalize()} {header.name}    |    {', '.join(facts)}"


def _motion_panels(log: FlightLog) -> list[Panel]:
    """Returns panels of the velocities and the height in the log."""
    panels: list[Panel] = [
        partial(draw_velocity, log=log, field=field) for field in VELOCITIES if log.motion.has_fields(field)
    ]
    return [*panels, partial(draw_height, log=log)] if log.motion.has_fields("down") else panels


def _angles(log: FlightLog) -> list[str]:
    return [field for field in ("roll", "pitch") if log.motion.has_fields(field)]


def _control_panel(log: FlightLog, field: str, limits: Limits) -> Panel:
    return lambda axes: draw_control(axes, log, field, limits)


def _navigation_panel(log: FlightLog, field: str, title: str) -> Panel:
    return lambda axes: draw_navigation_error(axes, log, field, title)


def _histories(log: FlightLog, panels: Sequence[Panel], *, strokes: bool = True) -> Figure:
    width = float(np.clip(INCHES_PER_SECOND * log.duration, NARROWEST, WIDEST))
    figure = palette.new_figure(width, 1.3 + 1.9 * len(panels))
    figure.suptitle(_headline(log), x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 3, fontweight="bold")
    _stack(figure, log, panels, width=0.94 * width, strokes=strokes)
    return figure


def _stack(
    figure: Figure | SubFigure,
    log: FlightLog,
    panels: Sequence[Panel],
    *,
    width: float,
    strokes: bool = True,
) -> None:
    """Stacks panels on one time axis, below the lane of primitives."""
    lanes = 1 if merged_primitives(log) else 0
    ratios = [*(0.26 for _ in range(lanes)), *(1.0 for _ in panels)]
    rows = figure.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)[:, 0]
    rest = rows[lanes:]
    if lanes:
        draw_primitive_lane(rows[0], log, width=width)
    for axes, draw in zip(rest, panels, strict=True):
        draw(axes)
    if strokes:
        palette.draw_legend_above(rest[0], stroke_legend(log))
    rest[-1].set_xlabel("time since start, s", fontsize=palette.TEXT_SIZE)
    figure.align_ylabels(rest)
