"""The walk through the trims that explains a motion best: matched step responses, dynamic programming.

A motion is taken as a chain of second-order steps between known velocities, with deviations of first order
around it. The likelihood of a step between two trims at an instant is a matched filter; which steps are
taken, and when, is found over all walks at once (Viterbi), at a cost that is linear in the flight time.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from .second_order_response import StepResponse

# Samples of a step that are matched, and the fewest between two steps; a sample is a tenth of the response
# time, so these are 6 and 1.5 response times.
MATCHED, APART = 60, 15
# What a step costs, and one out of a trim that was not reached, in twice the logarithm of a likelihood ratio:
# the second is no proof against a maneuver that ended by time-out, but nearly.
STEP_COST, UNREACHED_COST = 20.0, 1000.0


@dataclass(frozen=True, slots=True, eq=False)
class TrimGraph:
    """What a vehicle may hold, and how it may change.

    Attributes:
        velocity: of each trim: forward, side, yaw rate.
        band: half widths around each trim inside which it counts as reached.
        edges: a row for each possible step: places of the trims left and reached.
        dwell: seconds inside the band by which a trim counts as reached.
    """

    velocity: Float[np.ndarray, "trims 3"]
    band: Float[np.ndarray, "trims 3"]
    edges: Int[np.ndarray, "edges 2"]
    dwell: float


@dataclass(frozen=True, slots=True, eq=False)
class MotionModel:
    """How a vehicle follows its trims.

    Attributes:
        responses: of forward velocity, side velocity, yaw rate.
        scatter: standard deviations around the chain of steps.
        period: seconds between the samples that are matched.
        memory: how much of a deviation is left a sample later.
    """

    responses: tuple[StepResponse, StepResponse, StepResponse]
    scatter: Float[np.ndarray, "3"]
    period: float
    memory: float


@dataclass(frozen=True, slots=True)
class MatchedStep:
    """A step of a walk: seconds from the first sample, places of the trims left and reached."""

    time: float
    left: int
    reached: int


@dataclass(frozen=True, slots=True)
class MatchedWalk:
    """The trim held first, and the steps."""

    first: int
    steps: tuple[MatchedStep, ...]

    def mean_motion(self, graph: TrimGraph, model: MotionModel, samples: int) -> Float[np.ndarray, "n 3"]:
        """Returns the chain of steps without deviations."""
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
    """Returns the likeliest walk.

    Args:
        motion: forward velocity, side velocity, yaw rate, a sample every `model.period`.
        graph: the trims and steps to choose from.
        model: how the vehicle follows them.
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
    """Returns for each instant and edge what a step there changes in the cost of holding the trim reached."""
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
    """Returns where the motion has been inside each trim's band for the dwell."""
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
    """Returns the least cost of being in each trim, and whether it was entered `APART` samples before.

    Where it was not, it was held a sample before.
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
    # As many samples at once as two steps are apart: what they come from is known by then.
    for begin in range(APART + 1, count if len(edges) else 0, APART):
        place = np.arange(begin, min(begin + APART, count))
        by_edge = cost[place - APART][:, left] + stepping[place - APART]
        # Costs are compared without what holding the trim from the start would have cost.
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
