"""The pictures of a flight, each a file; the first one, `flight.png`, tells the story alone."""

import io
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure

from flight.errors import AlreadyExistsError
from flight.log import CONTROLS, ESTIMATE, WIND, FlightLog
from flight.log_file import publish_bytes

from . import palette
from .primitive_lane import draw_primitive_lane
from .time_histories import (
    draw_attitude,
    draw_control,
    draw_height,
    draw_navigation_error,
    draw_velocity,
    draw_wind,
    stroke_legend,
)
from .track_picture import draw_track
from .tracking import VELOCITIES

Panel = Callable[[Axes], None]
Limits = Mapping[str, tuple[float, float]]

# Inches of a page with nothing but time histories: wide enough that a long flight stays readable.
NARROWEST, WIDEST, INCHES_PER_SECOND = 12.0, 36.0, 0.11


def flight_picture(log: FlightLog) -> Figure:
    """Returns the page that tells the story of a flight: plan view beside velocities and height."""
    figure = palette.page(16.0, 9.6)
    figure.suptitle(_headline(log), x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 4, fontweight="bold")
    halves = figure.add_gridspec(1, 2, width_ratios=(0.43, 0.57))
    left, right = figure.add_subfigure(halves[0]), figure.add_subfigure(halves[1])
    track = left.subplots()
    palette.headline(track, "Seen from above: where it truly flew")
    draw_track(track, log)
    _stack(right, log, [*_velocity_panels(log), lambda axes: draw_height(axes, log)], width=8.6)
    return figure


def track_picture(log: FlightLog) -> Figure:
    """Returns the plan view alone, large."""
    figure = palette.page(10.0, 10.6)
    figure.suptitle(_headline(log), x=0.01, ha="left", fontsize=palette.TEXT_SIZE + 3, fontweight="bold")
    draw_track(figure.subplots(), log)
    return figure


def velocities_picture(log: FlightLog) -> Figure:
    """Returns velocities and height over time, as wide as the flight is long."""
    return _histories(log, [*_velocity_panels(log), lambda axes: draw_height(axes, log)])


def controls_picture(log: FlightLog, *, limits: Limits | None = None) -> Figure:
    """Returns attitude and controls over time.

    Args:
        log: the flight.
        limits: least and largest value of a control in radians, by field; those known.
    """
    panels: list[Panel] = [
        lambda axes: draw_attitude(axes, log, "roll"),
        lambda axes: draw_attitude(axes, log, "pitch"),
    ]
    if CONTROLS.name in log.series:
        panels += [_control_panel(log, field, limits or {}) for field in _CONTROLS]
    return _histories(log, panels, strokes=False)


def wind_picture(log: FlightLog) -> Figure:
    """Returns the air's motion at the vehicle over time.

    Raises:
        MissingTopicError: the log has no wind.
    """
    velocity, rotation = ("north", "east", "down"), ("rate_north", "rate_east", "rate_down")
    return _histories(
        log,
        [
            lambda axes: draw_wind(axes, log, velocity, "Air over the ground at the vehicle, m/s"),
            lambda axes: draw_wind(axes, log, rotation, "Rotation of the air about the world's axes, deg/s"),
        ],
        strokes=False,
    )


def navigation_picture(log: FlightLog) -> Figure:
    """Returns what was believed minus what was so, over time.

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
    """Draws every picture that the log has the topics for, and writes them as PNG files.

    Args:
        log: the flight.
        folder: where to; made if it is not there.
        limits: of the controls, as `controls_picture`.
        force: whether to overwrite.

    Returns:
        The files, the one to look at first before the others.

    Raises:
        AlreadyExistsError: one of the files exists and `force` is not set; nothing was written.
        FlightError: the log lacks truth or primitives, or an attachment is broken.
    """
    pictures: dict[str, Callable[[], Figure]] = {
        "flight": lambda: flight_picture(log),
        "track": lambda: track_picture(log),
        "velocities": lambda: velocities_picture(log),
        "attitude_and_controls": lambda: controls_picture(log, limits=limits),
    }
    if WIND.name in log.series:
        pictures["wind"] = lambda: wind_picture(log)
    if ESTIMATE.name in log.series:
        pictures["navigation_error"] = lambda: navigation_picture(log)
    paths = tuple(folder / f"{name}.png" for name in pictures)
    for path in paths:
        if path.exists() and not force:
            raise AlreadyExistsError(path)
    for path, draw in zip(paths, pictures.values(), strict=True):
        publish_picture(draw(), path, force=force)
    return paths


def publish_picture(figure: Figure, path: Path, *, force: bool = False) -> None:
    """Writes a figure as a PNG file, whole or not at all; equal figures give equal bytes.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
    """
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    publish_bytes(stream.getvalue(), path, force=force)


_CONTROLS = ("collective", "longitudinal", "lateral", "pedal")


def _headline(log: FlightLog) -> str:
    header = log.header
    facts = [f"{header.vehicle}", f"wind {header.wind}", f"seed {header.seed}", f"{log.duration:.1f} s"]
    if header.outcome != "completed":
        facts.append(header.outcome)
    return f"{header.kind.capitalize()} {header.name}    |    {', '.join(facts)}"


def _velocity_panels(log: FlightLog) -> list[Panel]:
    def panel(field: str) -> Panel:
        return lambda axes: draw_velocity(axes, log, field)

    return [panel(field) for field in VELOCITIES]


def _control_panel(log: FlightLog, field: str, limits: Limits) -> Panel:
    return lambda axes: draw_control(axes, log, field, limits)


def _navigation_panel(log: FlightLog, field: str, title: str) -> Panel:
    return lambda axes: draw_navigation_error(axes, log, field, title)


def _histories(log: FlightLog, panels: Sequence[Panel], *, strokes: bool = True) -> Figure:
    width = float(np.clip(INCHES_PER_SECOND * log.duration, NARROWEST, WIDEST))
    figure = palette.page(width, 1.3 + 1.9 * len(panels))
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
    """Draws panels below each other on one time axis, under the lane of primitives."""
    ratios = [0.26, *(1.0 for _ in panels)]
    lane, *rest = figure.subplots(len(panels) + 1, 1, sharex=True, height_ratios=ratios)
    draw_primitive_lane(lane, log, width=width)
    for axes, draw in zip(rest, panels, strict=True):
        draw(axes)
    if strokes:
        palette.legend_above(rest[0], stroke_legend(log))
    rest[-1].set_xlabel("time since start, s", fontsize=palette.TEXT_SIZE)
    figure.align_ylabels(rest)
