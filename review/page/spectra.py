"""Amplitude spectra of a page, over the whole flight."""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float
from scipy.signal import detrend, welch

from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ACTUATORS, CONTROLS, ESTIMATE, TRUTH

from .columns import pack_floats

Content = dict[str, object]
Column = Float[np.ndarray, "n"]
Frequencies = Float[np.ndarray, "frequencies"]

LONGEST_WINDOW = 20.0
"""Window length in seconds; the lowest frequency shown is its inverse."""

LEAST_SAMPLES = 64
MOST_FILLED = 10
"""Most samples of the even spacing, as a multiple of the logged ones."""
_DEGREES = float(np.degrees(1.0))
_SERVOS = ("collective_command", "longitudinal_command", "lateral_command", "pedal_command")
_RATES = ("roll_rate", "pitch_rate", "body_yaw_rate")


def spectra(logs: Sequence[FlightLog]) -> list[Content]:
    """Returns panels with spectra of controls and body rates.

    For compared flights each control and each rate has a panel of its own.
    """
    parts = [(number, *part) for number, log in enumerate(logs) for part in _signals(log)]
    panels: dict[tuple[str, str], list[Content]] = {}
    for number, title, unit, series, fields, scale in parts:
        for place, field in enumerate(fields):
            found = amplitude_density(series.time, scale * series[field])
            if found is None:
                continue
            name = field.removesuffix("_command").replace("_", " ")
            head = (f"{title}: {name}", unit) if len(logs) > 1 else (title, unit)
            curve = {"flight": number, "role": f"component{place % 4}", "label": name}
            panels.setdefault(head, []).append(
                {**curve, "frequency": pack_floats(found[0]), "values": pack_floats(found[1])}
            )
    return [{"title": title, "unit": unit, "curves": curves} for (title, unit), curves in panels.items()]


def amplitude_density(time: Column, values: Column) -> tuple[Frequencies, Frequencies] | None:
    """Returns frequencies > 0 in Hz and amplitude densities, values' unit/√Hz.

    Welch's method with Hann windows of half overlap; mean and slope of each window are removed; uneven
    samples are interpolated linearly to an even spacing. None for too few samples, a constant signal, or gaps
    that make up most of the time.
    """
    if len(time) < LEAST_SAMPLES or not np.ptp(values) > 0:
        return None
    step = float(np.median(np.diff(time)))
    if not step > 0 or time[-1] - time[0] > MOST_FILLED * step * len(time):
        return None
    even = np.arange(time[0], time[-1], step)
    window = min(len(even), max(LEAST_SAMPLES, round(LONGEST_WINDOW / step)))
    frequency, power = welch(np.interp(even, time, values), fs=1.0 / step, nperseg=window, detrend=detrend)
    return np.asarray(frequency[1:]), np.sqrt(power[1:])


def _signals(log: FlightLog) -> Iterator[tuple[str, str, Series, tuple[str, ...], float]]:
    """Yields title, unit, series, fields and scale of each group of signals."""
    if CONTROLS.name in log.series:
        yield "Servo commands", "deg / \u221aHz", log[CONTROLS], _SERVOS, _DEGREES
    if ACTUATORS.name in log.series:
        held = log[ACTUATORS].topic.field_names
        for place in range(0, len(held), 4):
            group = held[place : place + 4]
            title = "Controls" if len(held) <= 4 else f"Controls {place + 1} to {place + len(group)}"
            yield title, "as logged / \u221aHz", log[ACTUATORS], group, 1.0
    states = log.motion
    if states.topic.name in {TRUTH.name, ESTIMATE.name} and states.has_fields(*_RATES):
        yield "Body rates", "deg/s / \u221aHz", states, _RATES, _DEGREES
