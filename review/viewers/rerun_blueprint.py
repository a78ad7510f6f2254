"""Blueprint for Rerun: `python -m review.viewers.rerun_blueprint FILE.rbl`.

It needs rerun-sdk. Use it with a log converted under the same application id:

    rerun mcap convert flight.mcap --application-id maneuver --timeline-type duration -o flight.rrd
    rerun flight.rrd maneuver.rbl
"""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from flightlog.viewers.viewer_channels import PATH
from flightlog.viewers.z_up_frames import WORLD

APPLICATION = "maneuver"
"""Application id required of a converted log."""

WHITE, ORANGE, BLUE, VERMILION, GREY, GREEN = "#dddddd", "#e69f00", "#56b4e9", "#d55e00", "#8a8a8a", "#009e73"

STATE = (
    ("/command", "maneuver.Command", WHITE),
    ("/estimate", "maneuver.State", ORANGE),
    ("/truth", "maneuver.State", BLUE),
)


def blueprint() -> Any:
    """Returns the blueprint: path and events beside time histories."""
    import rerun as rr
    import rerun.blueprint as rrb

    motion = [
        _view(field.replace("_", " "), [(*part, field) for part in STATE])
        for field in ("forward", "side", "yaw_rate")
    ]
    controls = _components(
        "controls", "/controls", "maneuver.Controls", ("collective", "longitudinal", "lateral", "pedal")
    )
    wind = _components("wind", "/wind", "maneuver.Wind", ("north", "east", "down"))
    sigma = _components("one sigma", "/navigation", "maneuver.Spread", ("north", "east", "down"))
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Spatial3DView(
                    name="where it flew",
                    origin="/",
                    contents=[PATH.name],
                    spatial_information=rrb.SpatialInformation(target_frame=WORLD),
                    overrides={
                        PATH.name: rr.Ellipsoids3D(
                            half_sizes=[[0.12] * 3], colors=[_rgb(BLUE)], fill_mode="solid"
                        )
                    },
                ),
                rrb.TextLogView(name="events", origin="/events"),
                row_shares=[3, 1],
            ),
            rrb.Vertical(*motion, controls, wind, sigma),
        ),
        collapse_panels=True,
    )


def _components(name: str, topic: str, message: str, fields: Sequence[str]) -> Any:
    colors = (BLUE, VERMILION, GREY, GREEN)
    return _view(name, [(topic, message, color, field) for field, color in zip(fields, colors, strict=False)])


def _view(name: str, curves: Sequence[tuple[str, str, str, str]]) -> Any:
    """Returns a plot of curves given by topic, message, colour and field."""
    import rerun as rr
    import rerun.blueprint as rrb
    from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping

    lines: dict[Any, list[Any]] = {}
    for topic, message, color, field in curves:
        mapping = VisualizerComponentMapping(
            target="Scalars:scalars",
            source_kind=ComponentSourceKind.SourceComponent,
            source_component=f"{message}:message",
            selector=f".{field}",
        )
        line = rr.SeriesLines(names=f"{topic[1:]} {field}", colors=[_rgb(color)], widths=1.5)
        lines.setdefault(topic, []).append(line.visualizer(mappings=[mapping]))
    return rrb.TimeSeriesView(name=name, origin="/", contents=list(lines), overrides=lines)


def _rgb(color: str) -> list[int]:
    return [int(color[at : at + 2], 16) for at in (1, 3, 5)]


if __name__ == "__main__":
    blueprint().save(APPLICATION, Path(sys.argv[1]))
