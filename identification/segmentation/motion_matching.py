"""Most likely walk through the trims of a motion (Viterbi).

A motion is modelled as a chain of second-order steps between known velocities with first-order deviations
around it. The likelihood of a step between two trims at an instant is a matched filter; the steps and their
times are found over all walks at once (Viterbi), at a cost linear in the flight time.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from .second_order_response import StepResponse

# Samples of a step that are matched, and the fewest between two steps; a sample is a tenth of the response
# time, so these are 6 and 1.5 response times.
MATCHED, APART = 60, 15
# Costs of a step, and of a step out of a trim that was not reached, in twice the log-likelihood ratio; the
# second almost excludes maneuvers that ended by time-out.
STEP_COST, UNREACHED_COST = 20.0, 1000.0


@dataclass(frozen=True, slots=True, eq=False)
class TrimGraph:
    """Trims and possible steps between them.

    Attributes:
        velocity: velocity of each trim: forward, side, yaw rate.
        band: half widths around each trim inside which it counts as reached.
        edges: a row per possible step: indices of the trims left and reached.
        dwell: seconds inside the band after which a trim counts as reached.
    """

    velocity: Float[np.ndarray, "trims 3"]
    band: Float[np.ndarray, "trims 3"]
    edges: Int[np.ndarray, "edges 2"]
    dwell: float


@dataclass(frozen=True, slots=True, eq=False)
class MotionModel:
    """Model of a vehicle's motion around its trims.

    Attributes:
        responses: step responses of forward velocity, side velocity, yaw rate.
        scatter: standard deviations around the chain of steps.
        period: sampling period, seconds.
        memory: autocorrelation of deviations after one sample.
    """

    responses: tuple[StepResponse, StepResponse, StepResponse]
    scatter: Float[np.ndarray, "3"]
    period: float
    memory: float


@dataclass(frozen=True, slots=True)
class MatchedStep:
    """A step: seconds from the first sample, indices of both trims."""

    time: float
    left: int
    reached: int


@dataclass(frozen=True, slots=True)
class MatchedWalk:
    """The first trim and the steps of a walk."""

    first: int
    steps: tuple[MatchedStep, ...]

    def mean_motion(self, graph: TrimGraph, model: MotionModel, samples: int) -> Float[np.ndarray, "n 3"]:
        """Returns the motion of the steps without deviations."""
        velocity = graph.velocity
        mean = np.tile(velocity[self.first], (samples, 1))
        time = np.arange(samples) * model.period
        for step in self.steps:
            after = time > step.time
            for channel, response in enumerate(model.responses):
                aim, before = velocity[step.reached, channel], velocity[step.left, channel]
                share = response.remaining_share(time[after] - step.time)
                mean[after, channel] = aim + (before - aim) * share
        return mean


def match_walk(motion: Float[np.ndarray, "n 3"], graph: TrimGraph, model: MotionModel) -> MatchedWalk:
    """Returns the most likely walk.

    Args:
        motion: forward velocity, side velocity, yaw rate, sampled every `model.period`.
        graph: trims and possible steps.
        model: model of the vehicle's motion.
    """
    noise = model.scatter * np.sqrt(1 - model.memory**2)
    innovation = motion - model.memory * np.vstack([motion[:1], motion[:-1]])
    aims = (1 - model.memory) * graph.velocity
    holding = (((innovation[:, None, :] - aims) / noise) ** 2).sum(axis=2)
    stepping = _step_costs(innovation, graph, model, noise)
    stepping += np.where(
        _reached_trims(motion, graph, model.period)[:, graph.edges[:, 0]], 0.0, UNREACHED_COST
    )
    stepping += STEP_COST
    cost, entered = _least_costs(holding, stepping, graph.edges)
    return _trace_back(cost, entered, stepping, graph.edges, model.period)


def _step_costs(
    innovation: Float[np.ndarray, "n 3"], graph: TrimGraph, model: MotionModel, noise: Float[np.ndarray, "3"]
) -> Float[np.ndarray, "n edges"]:
    """Returns for each instant and edge the cost change by a step."""
    count = len(innovation)
    left, reached = graph.edges.T
    inside = np.minimum(MATCHED, count - 1 - np.arange(count))
    cost = np.zeros((count, len(graph.edges)))
    for channel, response in enumerate(model.responses):
        share = response.remaining_share(np.arange(MATCHED + 1) * model.period)
        template = share[1:] - model.memory * share[:-1]
        ahead = np.concatenate([innovation[1:, channel], np.zeros(MATCHED)])
        match = np.correlate(ahead, template, "valid")[:count, None]
        total = np.concatenate([[0.0], np.cumsum(template)])[inside, None]
        energy = np.concatenate([[0.0], np.cumsum(template**2)])[inside, None]
        aim = (1 - model.memory) * graph.velocity[reached, channel]
        size = graph.velocity[left, channel] - graph.velocity[reached, channel]
        cost += (size**2 * energy - 2 * size * (match - aim * total)) / noise[channel] ** 2
    return cost


def _reached_trims(
    motion: Float[np.ndarray, "n 3"], graph: TrimGraph, period: float
) -> Bool[np.ndarray, "n trims"]:
    """Returns True where the motion was inside a band for the dwell."""
    count = len(motion)
    inside = (np.abs(motion[:, None, :] - graph.velocity) <= graph.band).all(axis=2)
    so_far = np.vstack([np.zeros(inside.shape[1]), np.cumsum(inside, axis=0)])
    place = np.arange(count)
    since = np.maximum(place - round(graph.dwell / period), 0)
    there: Bool[np.ndarray, "n trims"] = so_far[place + 1] - so_far[since] == (place + 1 - since)[:, None]
    return there


def _least_costs(
    holding: Float[np.ndarray, "n trims"],
    stepping: Float[np.ndarray, "n edges"],
    edges: Int[np.ndarray, "e 2"],
) -> tuple[Float[np.ndarray, "n trims"], Bool[np.ndarray, "n trims"]]:
    """Returns the least cost of each trim, and True where just entered.

    An entered trim was entered `APART` samples before; otherwise it was held one sample before.
    """
    count, trims = holding.shape
    order = np.argsort(edges[:, 1], kind="stable")
    left, reached = edges[order].T
    stepping = stepping[:, order]
    heads = np.flatnonzero(np.r_[True, reached[1:] != reached[:-1]]) if len(edges) else np.empty(0, int)
    entered = reached[heads]
    total = np.vstack([np.zeros(trims), np.cumsum(holding, axis=0)])
    cost = total[1:].copy()
    stepped = np.zeros((count, trims), bool)
    # Blocks of `APART` samples: their predecessors are complete.
    for begin in range(APART + 1, count if len(edges) else 0, APART):
        place = np.arange(begin, min(begin + APART, count))
        by_edge = cost[place - APART][:, left] + stepping[place - APART]
        # Costs are compared relative to holding the trim from the start.
        coming = np.full((len(place), trims), np.inf)
        coming[:, entered] = (
            np.minimum.reduceat(by_edge, heads, axis=1) - total[place - APART + 1][:, entered]
        )
        staying = np.minimum.accumulate(np.vstack([cost[begin - 1] - total[begin], coming]), axis=0)
        cost[place] = staying[1:] + total[place + 1]
        stepped[place] = coming < staying[:-1]
    return cost, stepped


def _trace_back(
    cost: Float[np.ndarray, "n trims"],
    stepped: Bool[np.ndarray, "n trims"],
    stepping: Float[np.ndarray, "n edges"],
    edges: Int[np.ndarray, "edges 2"],
    period: float,
) -> MatchedWalk:
    steps, trim, place = [], int(np.argmin(cost[-1])), len(cost) - 1
    while place > 0:
        if not stepped[place, trim]:
            place -= 1
            continue
        place -= APART
        members = np.flatnonzero(edges[:, 1] == trim)
        left = edges[members, 0]
        before = int(left[np.argmin(cost[place, left] + stepping[place, members])])
        steps.append(MatchedStep(place * period, before, trim))
        trim = before
    return MatchedWalk(trim, tuple(reversed(steps)))
