"""Evaluates boxes of errors: time bounds and branching sensitivities.

The best times at the middle of a box are adjusted to its errors (`closure.py`). Times that become negative
for some errors are lengthened first; where a walk is too short to compensate large errors, some trim is held
longer than the middle needs: a detour that reaches the goal.
"""

from dataclasses import dataclass, field
from math import inf

import numpy as np
from jaxtyping import Bool, Float, Int

from flight.mission.mission import Mission
from flight.se2 import wrap_angle
from planner.kernel.exact import best_times
from planner.walks.goal_condition import goal_from_start, wants_heading

from .bounded_maximum import BoundedBoxes
from .closure import Closure, ClosureTimes, close_chain, closures_of
from .enclosure import enclose_end
from .error_path import ErrorPath

LEAST_HELD = 1e-3
"""Seconds above which a coasting time can be adjusted."""

SPREADS = (1.1, 1.3)
"""Factors by which a time is lengthened beyond what the errors need, tried in turn."""

DETOURS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5)
"""Least seconds in a trim, tried in turn."""

ESCAPES = (0.0, 1.5, 3.0, 5.0, 8.0, 13.0, 20.0, 30.0)
"""Likewise, where no bound is known yet."""

FOREVER = 1e9
"""Seconds; a bound on any finite time."""

COSTS = 0.3
"""Usual least share of a detour's seconds that it adds to the time."""


@dataclass(eq=False)
class BoxState:
    """State of a batch of boxes.

    Attributes:
        boxes: the batch; their bounds are those of the boxes that they come from.
        cost: seconds that their middles need.
        times: with which.
        bound: seconds that suffice for each box.
        corner: errors in each box that seem slowest.
        sensitivity: shift of the walk's end by each variable.
        rank: quality of the attempt that gave the sensitivity.
        weight: of a second in ranks, relative to a second of margin in the adjusted times.
    """

    boxes: BoundedBoxes
    cost: Float[np.ndarray, "n"]
    times: Float[np.ndarray, "n trims"]
    weight: float
    bound: Float[np.ndarray, "n"] = field(init=False)
    corner: Float[np.ndarray, "n variables"] = field(init=False)
    sensitivity: Float[np.ndarray, "n variables"] = field(init=False)
    rank: Float[np.ndarray, "n"] = field(init=False)

    def __post_init__(self) -> None:
        self.bound, self.rank = np.full(len(self.cost), inf), np.full(len(self.cost), inf)
        self.corner = self.boxes.middle.copy()
        self.sensitivity = np.zeros_like(self.corner)


class BoxEvaluator:
    """Evaluator of error boxes of one walk.

    Args:
        path: the walk.
        mission: from where to where.
    """

    def __init__(self, path: ErrorPath, mission: Mission) -> None:
        self._path, self._mission = path, mission
        self._goal = goal_from_start(mission)
        self._closures = closures_of(path, heading=wants_heading(mission), tolerance=mission.tolerance)

    def costs(self, errors: Float[np.ndarray, "n variables"]) -> Float[np.ndarray, "n"]:
        """Returns the least seconds for each choice of errors."""
        return best_times(self._path.table(errors), self._mission)[0]

    def fine_bounds(self, boxes: BoundedBoxes, enough: float) -> BoxState:
        """Returns the tightest available bounds for boxes.

        Args:
            boxes: of errors.
            enough: seconds below which a bound suffices.
        """
        state = self._initial_state(boxes, weight=10.0)
        if np.isfinite(state.cost).all():
            self._try_closures(state, np.arange(len(state.cost)), state.times, enough, longer=SPREADS)
            self._try_detours(state, DETOURS, enough, longer=SPREADS[:1])
            self._set_sensitivity(state)
        return state

    def coarse_bounds(self, boxes: BoundedBoxes, enough: float) -> BoxState:
        """Returns bounds for boxes from the shortest successful detours."""
        state = self._initial_state(boxes, weight=0.0)
        if np.isfinite(state.cost).all():
            for seconds in ESCAPES:
                self._try_detours(state, (seconds,), max(enough, FOREVER), longer=SPREADS)
            self._set_sensitivity(state)
        return state

    def _initial_state(self, boxes: BoundedBoxes, *, weight: float) -> BoxState:
        return BoxState(boxes, *best_times(self._path.table(boxes.middle), self._mission), weight)

    def _set_sensitivity(self, state: BoxState) -> None:
        """Sets the default sensitivity: the motion of the end."""
        lost = state.sensitivity.sum(axis=1) == 0
        middle, times = state.boxes.middle[lost], state.times[lost]
        still = np.zeros((*times.shape, middle.shape[1]))
        state.sensitivity[lost] = enclose_end(
            self._path, middle, state.boxes.width[lost], times, still
        ).influence

    def _try_detours(
        self, state: BoxState, seconds: tuple[float, ...], enough: float, *, longer: tuple[float, ...] = ()
    ) -> None:
        """Tries longer coasts, trim by trim, in boxes without a sufficient bound."""
        rows, places = np.flatnonzero(state.bound > enough), len(self._path.walk)
        if places == 1:
            return
        row = np.repeat(rows, places * len(seconds))
        place = np.tile(np.repeat(np.arange(places), len(seconds)), len(rows))
        held = np.tile(seconds, len(rows) * places)
        promising = state.cost[row] + COSTS * held < enough
        row, place, held = row[promising], place[promising], held[promising]
        least = np.zeros((len(row), places))
        least[np.arange(len(row)), place] = held
        cost, times = self._best_held_times(state, row, least)
        useful = cost < np.minimum(state.bound[row], enough)
        self._try_closures(state, row[useful], times[useful], enough, longer=longer)

    def _best_held_times(
        self, state: BoxState, row: Int[np.ndarray, "m"], least: Float[np.ndarray, "m trims"]
    ) -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m trims"]]:
        """Returns least-cost times with lower limits, for the middles of boxes."""
        cost, times = best_times(self._path.table(state.boxes.middle[row], least), self._mission)
        return cost, times + least

    def _try_closures(
        self,
        state: BoxState,
        row: Int[np.ndarray, "m"],
        times: Float[np.ndarray, "m trims"],
        enough: float,
        *,
        longer: tuple[float, ...] = (),
    ) -> None:
        """Tries all closures; lengthens coasts that become too short."""
        for closure in self._closures:
            use = self._can_answer(times, closure) & (state.bound[row] > enough)
            trying, base = row[use], times[use]
            for share in (*longer, None):
                if not len(trying):
                    break
                closed = self._close(state, trying, base, closure)
                short = self._record(state, trying, closed, closure, base) & (state.bound[trying] > enough)
                if share is None or not closure.answering or len(self._path.walk) == 1:
                    break
                least = np.zeros((int(short.sum()), base.shape[1]))
                for place in closure.answering:
                    with np.errstate(all="ignore"):
                        reach = closed.times[place].reach
                    least[:, place] = np.minimum(share * reach[short], ESCAPES[-1])
                cost, base = self._best_held_times(state, trying[short], least)
                trying, base = trying[short][np.isfinite(cost)], base[np.isfinite(cost)]

    @staticmethod
    def _can_answer(times: Float[np.ndarray, "m trims"], closure: Closure) -> Bool[np.ndarray, "m"]:
        if not closure.answering:
            return np.asarray(~times.any(axis=1))
        return np.asarray(times[:, closure.answering].min(axis=1) > LEAST_HELD)

    def _close(
        self,
        state: BoxState,
        row: Int[np.ndarray, "m"],
        times: Float[np.ndarray, "m trims"],
        closure: Closure,
    ) -> ClosureTimes:
        middle = state.boxes.middle[row]
        alone = closure.turn is None and len(closure.others) < 2
        goal = np.full(len(row), self._goal) if alone else self._path.at(middle).end(times)
        return close_chain(
            self._path,
            middle,
            state.boxes.width[row],
            times,
            goal=goal,
            tolerance=self._mission.destination.reach,
            closure=closure,
        )

    def _record(
        self,
        state: BoxState,
        row: Int[np.ndarray, "m"],
        closed: ClosureTimes,
        closure: Closure,
        times: Float[np.ndarray, "m trims"],
    ) -> Bool[np.ndarray, "m"]:
        """Records better bounds; returns where only a time's sign is wrong."""
        shortest = np.full(len(row), inf)
        # Numbers without bounds, where nothing holds, may overflow.
        with np.errstate(all="ignore"):
            for time in closed.times.values():
                shortest = np.minimum(shortest, time.low)
            holds = closed.holds & self._meets_heading(closed)
            bound = np.where(holds & (shortest >= 0), closed.seconds.high, inf)
        # Of failed attempts, the one whose times are least too short ranks highest.
        held = times[:, closure.answering].min(axis=1) if closure.answering else np.zeros(len(row))
        fails = np.where(holds, FOREVER - shortest, 2 * FOREVER + state.weight * times.sum(axis=1) - held)
        rank = np.where(np.isfinite(bound), bound, fails)
        variables = state.boxes.middle.shape[1]
        # Rows may come more than once: the best comes last.
        for at in np.argsort(-rank, kind="stable"):
            if rank[at] < state.rank[row[at]]:
                state.rank[row[at]], state.sensitivity[row[at]] = rank[at], closed.sensitivity[at]
            if bound[at] < state.bound[row[at]]:
                state.bound[row[at]] = bound[at]
                toward = np.sign(closed.seconds.slope[at, :variables])
                state.corner[row[at]] = state.boxes.middle[row[at]] + toward * state.boxes.width[row[at]]
        return np.asarray(holds & (shortest < 0))

    def _meets_heading(self, closed: ClosureTimes) -> Bool[np.ndarray, "m"]:
        """Returns True where the heading at the end is as wanted."""
        mission = self._mission
        if mission.goal_heading is None or not wants_heading(mission):
            return np.ones(len(closed.holds), dtype=bool)
        wanted = mission.goal_heading - mission.start.heading
        off = np.array([abs(wrap_angle(one - wanted)) for one in closed.heading.middle.tolist()])
        allowed = mission.destination.heading_reach
        faces: Bool[np.ndarray, "m"] = off + closed.heading.reach <= allowed
        return faces
