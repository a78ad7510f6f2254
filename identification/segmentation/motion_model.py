"""Model of a vehicle's motion around trims, learnt from motion alone."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flightlog.log import FlightLog

from .motion_matching import MATCHED, MatchedWalk, MotionModel, TrimGraph, match_walk
from .second_order_response import StepResponse, fit_response

# Candidate natural frequencies, rad/s; the response time is the inverse, and a sample a tenth of it.
FREQUENCIES = (0.5, 1.0, 2.0, 4.0)
SAMPLES_A_RESPONSE_TIME = 10
# The correlation time of deviations is a response time.
MEMORY = float(np.exp(-1 / SAMPLES_A_RESPONSE_TIME))
# A band is about three standard deviations wide, which bounds the scatter from above.
BAND_IN_SCATTERS = 3.0
# Steps below this many standard deviations are not used for the responses.
VISIBLE = 4.0
# Numbers of flights for the time scale and for the responses; passes over them.
FEW, MANY, PASSES = 3, 12, 3
# Least sampling rate of a log, Hz.
SLOWEST_RATE = 20.0
# Median absolute deviation over standard deviation of a normal distribution.
MAD = 0.6745

MotionSamples = Float[np.ndarray, "_ 3"]
FINE_PERIOD = 0.025
"""Sampling period of the motion taken from a log, seconds."""


class TooSlowLogError(FlightError):
    """The log is too short or sampled too slowly for segmentation."""


def sampled_motion(log: FlightLog) -> MotionSamples:
    """Returns forward, side velocity and yaw rate, averaged over `FINE_PERIOD`.

    Raises:
        TooSlowLogError: fewer than 20 samples per second, or a flight of less than a few seconds.
        MissingTopicError: the log has neither true nor estimated motion.
    """
    series = log.motion
    time = series.time
    gap = float(np.diff(time).max()) if len(time) > 1 else np.inf
    if gap > 1.5 / SLOWEST_RATE or time[-1] - time[0] < 2 * MATCHED * FINE_PERIOD:
        raise TooSlowLogError(
            f"expected {series.topic.name} at {SLOWEST_RATE:g} Hz or more, for at least "
            f"{2 * MATCHED * FINE_PERIOD:g} s; got {len(time)} samples, up to {gap:.3f} s apart"
        )
    values = np.stack([series[name] for name in ("forward", "side", "yaw_rate")], axis=1)
    if not np.isfinite(values).all():
        raise TooSlowLogError(f"expected finite velocities in {series.topic.name}, got NaN or infinity")
    return _period_means(time - time[0], values, FINE_PERIOD)


def downsample(motion: MotionSamples, period: float) -> MotionSamples:
    """Averages a sampled motion over a longer period, centred, in seconds."""
    time = (np.arange(len(motion)) + 0.5) * FINE_PERIOD
    return _period_means(time, motion, period)


def _period_means(time: Float[np.ndarray, "n"], values: MotionSamples, period: float) -> MotionSamples:
    """Returns means over periods centred on multiples of the period."""
    centres = np.arange(0.0, time[-1] - time[0], period) + time[0]
    low = np.maximum(centres - period / 2, time[0])
    high = np.minimum(centres + period / 2, time[-1])
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(time)[:, None]
    total = np.vstack([np.zeros(values.shape[1]), np.cumsum(steps, axis=0)])
    columns = [(np.interp(high, time, one) - np.interp(low, time, one)) / (high - low) for one in total.T]
    return np.stack(columns, axis=1)


def learn_model(motions: Sequence[MotionSamples], graph: TrimGraph) -> MotionModel:
    """Learns the model of motion from the most likely walks.

    Args:
        motions: one per flight, from `sampled_motion`.
        graph: trims and possible steps.
    """
    few, many = _subset(motions, FEW), _subset(motions, MANY)
    tried = [
        _refine_model(few, graph, _initial_model(graph, frequency), passes=1) for frequency in FREQUENCIES
    ]
    model = min(tried, key=lambda one: _misfit(few, graph, one))
    return _refine_model(many, graph, model, passes=PASSES)


def likeliest_walk(motion: MotionSamples, graph: TrimGraph, model: MotionModel) -> MatchedWalk:
    """Returns the most likely walk of a motion from `sampled_motion`."""
    return match_walk(downsample(motion, model.period), graph, model)


def _subset(motions: Sequence[MotionSamples], count: int) -> list[MotionSamples]:
    places = np.unique(np.linspace(0, len(motions) - 1, count).round().astype(int))
    return [motions[place] for place in places]


def _initial_model(graph: TrimGraph, frequency: float) -> MotionModel:
    response = StepResponse(frequency, 0.8)
    return MotionModel(
        responses=(response, response, response),
        scatter=np.median(graph.band, axis=0) / BAND_IN_SCATTERS,
        period=1 / (SAMPLES_A_RESPONSE_TIME * frequency),
        memory=MEMORY,
    )


def _refine_model(
    motions: Sequence[MotionSamples], graph: TrimGraph, model: MotionModel, *, passes: int
) -> MotionModel:
    sampled = [downsample(motion, model.period) for motion in motions]
    for _ in range(passes):
        walks = [match_walk(motion, graph, model) for motion in sampled]
        forward, side, yaw_rate = (
            _fit_channel(sampled, walks, graph, model, channel) for channel in range(3)
        )
        model = replace(model, responses=(forward, side, yaw_rate))
        off = [
            motion - walk.mean_motion(graph, model, len(motion))
            for motion, walk in zip(sampled, walks, strict=True)
        ]
        every = np.concatenate(off)
        # The robust estimate ignores misfits of the responses, the rms includes them: their mean square is
        # used.
        robust, rms = np.median(np.abs(every), axis=0) / MAD, np.sqrt((every**2).mean(axis=0))
        scatter = np.sqrt(0.5 * (robust**2 + rms**2))
        widest = np.median(graph.band, axis=0) / BAND_IN_SCATTERS
        model = replace(model, scatter=np.clip(scatter, 0.1 * widest, widest))
    return model


def _fit_channel(
    motions: Sequence[MotionSamples],
    walks: Sequence[MatchedWalk],
    graph: TrimGraph,
    model: MotionModel,
    channel: int,
) -> StepResponse:
    steps = []
    for motion, walk in zip(motions, walks, strict=True):
        times = [*(step.time for step in walk.steps), len(motion) * model.period]
        for step, end in zip(walk.steps, times[1:], strict=True):
            aim = graph.velocity[step.reached, channel]
            size = graph.velocity[step.left, channel] - aim
            first = round(step.time / model.period)
            last = min(first + MATCHED, round(end / model.period))
            if abs(size) > VISIBLE * model.scatter[channel]:
                steps.append((motion[first:last, channel] - aim) / size)
    if len(steps) < 3:
        return model.responses[channel]
    return fit_response(steps, period=model.period, memory=model.memory, guess=model.responses[channel])


def _misfit(motions: Sequence[MotionSamples], graph: TrimGraph, model: MotionModel) -> float:
    """Returns the mean square deviation from the walks, in bands."""
    squares = []
    for motion in motions:
        sampled = downsample(motion, model.period)
        mean = match_walk(sampled, graph, model).mean_motion(graph, model, len(sampled))
        squares.append((((sampled - mean) / np.median(graph.band, axis=0)) ** 2).mean())
    return float(np.mean(squares))
