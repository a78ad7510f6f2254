"""Plot panels of a page: titles, units, curves, bands and limits."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import degrees

import numpy as np
from jaxtyping import Float

from flightlog.log import FlightLog
from flightlog.series import Series, Topic
from flightlog.topics import ACTUATORS, COMMAND, CONTROLS, ESTIMATE, MOTION, NAVIGATION, TRUTH, WIND
from review.summary.tracking import interpolate_field, navigation_error

from .columns import PageColumns

Limits = Mapping[str, tuple[float, float]]
Content = dict[str, object]

DEGREES = degrees(1.0)
UNEVEN_SAMPLING = 1.5
"""Ratio of longest to median gap between samples above which gaps are plotted."""

SIGMAS = 3.0
"""Half width of the band around zero error, in standard deviations."""


@dataclass(frozen=True, slots=True)
class _Panel:
    """Definition of a panel: fields of one topic and their scale."""

    section: str
    title: str
    unit: str
    fields: tuple[str, ...]
    scale: float = 1.0
    least_span: float = 0.5
    short: bool = False


_MOTION = (
    _Panel("Motion", "Forward speed", "m/s", ("forward",)),
    _Panel("Motion", "Sideward speed, right positive", "m/s", ("side",)),
    _Panel("Motion", "Yaw rate, right turn positive", "deg/s", ("yaw_rate",), DEGREES, 4.0),
    _Panel("Motion", "Height above ground", "m", ("down",), -1.0, 2.0),
    _Panel("Motion", "Rate of climb", "m/s", ("descent",), -1.0, 0.5, short=True),
    _Panel("Motion", "North of the origin", "m", ("north",), 1.0, 2.0, short=True),
    _Panel("Motion", "East of the origin", "m", ("east",), 1.0, 2.0, short=True),
    _Panel("Attitude", "Roll, right side down positive", "deg", ("roll",), DEGREES, 2.0),
    _Panel("Attitude", "Pitch, nose up positive", "deg", ("pitch",), DEGREES, 2.0),
    _Panel("Attitude", "Heading, clockwise from north, not wrapped", "deg", ("heading",), DEGREES, 5.0),
)
_RATES = _Panel("Attitude", "Body rates", "deg/s", ("roll_rate", "pitch_rate", "body_yaw_rate"), DEGREES, 4.0)
_CONTROLS = tuple(
    _Panel("Controls", title, "deg", (field,), DEGREES, 1.0, short=True)
    for field, title in (
        ("collective", "Collective pitch"),
        ("longitudinal", "Longitudinal cyclic, nose up positive"),
        ("lateral", "Lateral cyclic, right positive"),
        ("pedal", "Tail rotor pitch, right turn positive"),
    )
)
_WIND = (
    _Panel("Wind", "Air over the ground at the vehicle", "m/s", ("north", "east", "down")),
    _Panel(
        "Wind", "Rotation of the air", "deg/s", ("rate_north", "rate_east", "rate_down"), DEGREES, 1.0, True
    ),
)
_NAVIGATION = (
    _Panel("Navigation", "Estimated minus actual: north", "m", ("north",), 1.0, 0.1, True),
    _Panel("Navigation", "Estimated minus actual: east", "m", ("east",), 1.0, 0.1, True),
    _Panel("Navigation", "Estimated minus actual: down", "m", ("down",), 1.0, 0.1, True),
    _Panel("Navigation", "Estimated minus actual: forward speed", "m/s", ("forward",), 1.0, 0.02, True),
    _Panel("Navigation", "Estimated minus actual: sideward speed", "m/s", ("side",), 1.0, 0.02, True),
    _Panel("Navigation", "Estimated minus actual: heading", "deg", ("heading",), DEGREES, 0.5, True),
)
_COMMANDED = {"forward": "forward", "side": "side", "yaw_rate": "yaw_rate", "down": "height"}


def panels(logs: Sequence[FlightLog], columns: PageColumns, limits: Limits) -> list[Content]:
    """Returns the panels that the logs have topics for.

    Args:
        logs: one flight, or several to compare.
        columns: receives the numbers.
        limits: limits of the controls in radians, by field.
    """
    shared = _PanelBuilder(tuple(logs), columns)
    filled = [shared.motion(_with_height_reference(panel, logs)) for panel in _MOTION]
    filled += shared.components(_RATES, logs[0].motion.topic)
    filled += [shared.control(panel, limits) for panel in _CONTROLS]
    filled += [part for panel in _actuators(logs) for part in shared.components(panel, ACTUATORS)]
    filled += [part for panel in _WIND for part in shared.components(panel, WIND)]
    filled += [shared.navigation(panel) for panel in _NAVIGATION]
    filled += [shared.gaps()]
    return [panel for panel in filled if panel["curves"]]


def _with_height_reference(panel: _Panel, logs: Sequence[FlightLog]) -> _Panel:
    """Returns the panel with the height reference of an imported log."""
    if panel.fields == ("down",) and any(log.header.kind == "import" for log in logs):
        return replace(panel, title="Height above the log's origin")
    return panel


def _actuators(logs: Sequence[FlightLog]) -> Iterator[_Panel]:
    """Yields panels of four numbered controls each."""
    held = {
        name: None
        for log in logs
        if ACTUATORS.name in log.series
        for name in log[ACTUATORS].topic.field_names
    }
    names = tuple(held)
    for place in range(0, len(names), 4):
        title = f"Controls {', '.join(name.removeprefix('control_') for name in names[place : place + 4])}"
        yield _Panel("Controls", title, "as logged", names[place : place + 4], 1.0, 0.05)


@dataclass(frozen=True, slots=True)
class _PanelBuilder:
    logs: tuple[FlightLog, ...]
    columns: PageColumns

    def motion(self, panel: _Panel) -> Content:
        """Returns a state panel: commanded, estimated, actual."""
        (field,) = panel.fields
        curves = []
        for number, log in enumerate(self.logs):
            known = field in _COMMANDED and COMMAND.name in log.series
            if known and log[COMMAND].has_fields(_COMMANDED[field]):
                scale = 1.0 if field == "down" else panel.scale
                curves.append(self._curve(number, "commanded", log[COMMAND], _COMMANDED[field], scale))
            for role, states in self._states(log):
                if states.has_fields(field):
                    curves.append(self._curve(number, role, states, field, panel.scale))
        band = field if field in {"forward", "side", "yaw_rate"} and len(self.logs) == 1 else None
        return self._content(panel, curves, band=band)

    def _states(self, log: FlightLog) -> Iterator[tuple[str, Series]]:
        """Yields estimated and actual states; of compared flights one."""
        if len(self.logs) > 1:
            role = "estimated" if log.motion.topic.name == ESTIMATE.name else "actual"
            yield role, log.motion
            return
        for role, topic in (("estimated", ESTIMATE), ("actual", TRUTH), ("actual", MOTION)):
            if topic.name in log.series:
                yield role, log[topic]

    def control(self, panel: _Panel, limits: Limits) -> Content:
        """Returns a control panel: servo command, servo position, limits."""
        (field,) = panel.fields
        curves = []
        for number, log in enumerate(self.logs):
            if CONTROLS.name in log.series:
                series = log[CONTROLS]
                curves.append(self._curve(number, "actual", series, field, panel.scale))
                if len(self.logs) == 1:
                    curves.insert(
                        0, self._curve(number, "commanded", series, f"{field}_command", panel.scale)
                    )
        shown = [panel.scale * limit for limit in limits.get(field, ())]
        return self._content(panel, curves, limits=shown)

    def components(self, panel: _Panel, topic: Topic) -> list[Content]:
        """Returns a panel of a topic's fields; of compared flights several."""
        have = [(number, log[topic]) for number, log in enumerate(self.logs) if topic.name in log.series]
        if len(self.logs) == 1:
            curves = [
                self._curve(number, f"component{place}", series, field, panel.scale)
                for number, series in have
                for place, field in enumerate(panel.fields)
                if series.has_fields(field)
            ]
            return [self._content(panel, curves)]
        single = []
        for field in panel.fields:
            title = f"{panel.title}: {field.replace('_', ' ')}"
            curves = [
                self._curve(number, "actual", series, field, panel.scale)
                for number, series in have
                if series.has_fields(field)
            ]
            single.append(self._content(replace(panel, title=title, fields=(field,), short=True), curves))
        return single

    def navigation(self, panel: _Panel) -> Content:
        """Returns a panel of estimate minus truth with the estimated sigma."""
        (field,) = panel.fields
        curves: list[Content] = []
        for number, log in enumerate(self.logs):
            if not all(
                topic.name in log.series and log[topic].has_fields(field) for topic in (TRUTH, ESTIMATE)
            ):
                continue
            time = log[TRUTH].time
            error = panel.scale * navigation_error(log, field)
            curves.append(self._placed(number, "error", "error", time, error))
            if NAVIGATION.name in log.series and len(self.logs) == 1:
                band = SIGMAS * panel.scale * interpolate_field(log[NAVIGATION], field, time)
                for role, edge in (("sigma_high", band), ("sigma_low", -band)):
                    curves.append(self._placed(number, role, f"{SIGMAS:.0f} sigma", time, edge))
        return self._content(panel, curves)

    def gaps(self) -> Content:
        """Returns a panel of sampling gaps of unevenly sampled topics."""
        panel = _Panel("Log", "Time between samples, where it is uneven", "s", (), 1.0, 0.01, short=True)
        curves: list[Content] = []
        for topic in (TRUTH, ESTIMATE, CONTROLS, ACTUATORS) if len(self.logs) == 1 else ():
            series = self.logs[0].series.get(topic.name)
            if series is None or len(series) < 3:
                continue
            gaps = np.diff(series.time)
            if gaps.max() > UNEVEN_SAMPLING * np.median(gaps):
                role = f"component{len(curves)}"
                curves.append(self._placed(0, role, topic.name, series.time[1:], gaps))
        return self._content(panel, curves)

    def _curve(self, number: int, role: str, series: Series, field: str, scale: float) -> Content:
        label = field.replace("_", " ") if role.startswith("component") else role
        return self._placed(number, role, label, series.time, scale * series[field])

    def _placed(
        self,
        number: int,
        role: str,
        label: str,
        time: Float[np.ndarray, "n"],
        values: Float[np.ndarray, "n"],
    ) -> Content:
        base, column = self.columns.add(time, values)
        return {"flight": number, "role": role, "label": label, "base": base, "column": column}

    @staticmethod
    def _content(
        panel: _Panel,
        curves: list[Content],
        *,
        band: str | None = None,
        limits: Sequence[float] = (),
    ) -> Content:
        return {
            "section": panel.section,
            "title": panel.title,
            "unit": panel.unit,
            "leastSpan": panel.least_span,
            "short": panel.short,
            "curves": curves,
            "band": band,
            "bandScale": panel.scale,
            "limits": list(limits),
        }
