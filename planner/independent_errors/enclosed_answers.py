"""What is known of the times that answer the errors of a box: seconds that suffice, and where to cut it.

Times that are best in the middle of a box answer its errors in some way (`closing.py`). Those that become
negative for some errors are held longer from the start; and where a walk is too short to answer large errors,
some trim is held for longer than the middle asks for: a detour, but one that arrives.
"""

from dataclasses import dataclass, field
from math import inf
from typing import Self

import numpy as np
from jaxtyping import Bool, Float, Int

from flight.mission.mission import Mission
from flight.se2 import wrap_angle
from planner.kernel.exact import best_of_each
from planner.walks.goal import goal_seen, wants_heading

from .closing import Closed, Way, close, ways
from .enclosure import enclose
from .error_path import ErrorPath

HELD = 1e-3
"""Seconds above which a coasting time can answer."""

SPREADS = (1.1, 1.3)
"""How much longer than errors ask for a time is held from the start, one after the other."""

DETOURS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5)
"""Seconds that a trim is held at least."""

ESCAPES = (0.0, 1.5, 3.0, 5.0, 8.0, 13.0, 20.0, 30.0)
"""Likewise, where anything that arrives is welcome."""

FOREVER = 1e9
"""Seconds; any time that is not infinite."""

COSTS = 0.3
"""Share of a detour's seconds that it costs, at least, as a rule."""


@dataclass(frozen=True, slots=True, eq=False)
class Boxes:
    """Boxes of errors.

    Attributes:
        middle: error variables in the middle of each.
        width: half widths.
        bound: seconds that suffice for each; infinite where none are known.
    """

    middle: Float[np.ndarray, "n variables"]
    width: Float[np.ndarray, "n variables"]
    bound: Float[np.ndarray, "n"]

    @classmethod
    def whole(cls, variables: int) -> Self:
        """Returns the one box of all errors."""
        return cls(np.zeros((1, variables)), np.ones((1, variables)), np.array([inf]))

    def take(self, which: Bool[np.ndarray, "n"] | Int[np.ndarray, "m"]) -> "Boxes":
        """Returns some of them."""
        return Boxes(self.middle[which], self.width[which], self.bound[which])

    def halves(self, place: Int[np.ndarray, "n"]) -> "Boxes":
        """Returns both halves of each, cut along the variables at these places."""
        rows = np.arange(len(place))
        width, shift = self.width.copy(), np.zeros_like(self.width)
        width[rows, place] *= 0.5
        shift[rows, place] = width[rows, place]
        middle = np.concatenate([self.middle - shift, self.middle + shift])
        return Boxes(middle, np.tile(width, (2, 1)), np.tile(self.bound, 2))


def joined(one: Boxes, two: Boxes) -> Boxes:
    """Returns all boxes in one."""
    return Boxes(
        np.concatenate([one.middle, two.middle]),
        np.concatenate([one.width, two.width]),
        np.concatenate([one.bound, two.bound]),
    )


@dataclass(eq=False)
class Look:
    """What is known of a batch of boxes.

    Attributes:
        boxes: the batch; their bounds are those of the boxes that they come from.
        cost: seconds that their middles need.
        times: with which.
        bound: seconds that suffice for each box.
        corner: errors in each box that seem slowest.
        blame: how far each variable bends the walk.
        rank: how near the attempt came that gave the blame.
        dear: what a second counts for, beside a second that answering times may become shorter, in ranks.
    """

    boxes: Boxes
    cost: Float[np.ndarray, "n"]
    times: Float[np.ndarray, "n trims"]
    dear: float
    bound: Float[np.ndarray, "n"] = field(init=False)
    corner: Float[np.ndarray, "n variables"] = field(init=False)
    blame: Float[np.ndarray, "n variables"] = field(init=False)
    rank: Float[np.ndarray, "n"] = field(init=False)

    def __post_init__(self) -> None:
        self.bound, self.rank = np.full(len(self.cost), inf), np.full(len(self.cost), inf)
        self.corner = self.boxes.middle.copy()
        self.blame = np.zeros_like(self.corner)


class Answers:
    """Looks at boxes of errors of a walk.

    Args:
        path: the walk.
        mission: from where to where.
    """

    def __init__(self, path: ErrorPath, mission: Mission) -> None:
        self._path, self._mission = path, mission
        self._goal = goal_seen(mission)
        self._ways = ways(path, heading=wants_heading(mission), tolerance=mission.tolerance)

    def costs(self, errors: Float[np.ndarray, "n variables"]) -> Float[np.ndarray, "n"]:
        """Returns the seconds that errors take, with the best times for each."""
        return best_of_each(self._path.table(errors), self._mission)[0]

    def close(self, boxes: Boxes, enough: float) -> Look:
        """Returns bounds for boxes, as close as they are to be had.

        Args:
            boxes: of errors.
            enough: seconds below which no closer bound is looked for.
        """
        look = self._begun(boxes, dear=10.0)
        if np.isfinite(look.cost).all():
            self._attempts(look, np.arange(len(look.cost)), look.times, enough, longer=SPREADS)
            self._detours(look, DETOURS, enough, longer=SPREADS[:1])
            self._blame(look)
        return look

    def coarse(self, boxes: Boxes, enough: float) -> Look:
        """Returns bounds for boxes by the shortest detours that give any; arguments as in `close`."""
        look = self._begun(boxes, dear=0.0)
        if np.isfinite(look.cost).all():
            for seconds in ESCAPES:
                self._detours(look, (seconds,), max(enough, FOREVER), longer=SPREADS)
            self._blame(look)
        return look

    def _begun(self, boxes: Boxes, *, dear: float) -> Look:
        return Look(boxes, *best_of_each(self._path.table(boxes.middle), self._mission), dear)

    def _blame(self, look: Look) -> None:
        """Says where to cut boxes that no attempt has looked at: where the end moves most."""
        lost = look.blame.sum(axis=1) == 0
        middle, times = look.boxes.middle[lost], look.times[lost]
        still = np.zeros((*times.shape, middle.shape[1]))
        look.blame[lost] = enclose(self._path, middle, look.boxes.width[lost], times, still).influence

    def _detours(
        self, look: Look, seconds: tuple[float, ...], enough: float, *, longer: tuple[float, ...] = ()
    ) -> None:
        """Lets each trim in turn be held for longer than it has to be, in boxes whose bound is not enough."""
        rows, places = np.flatnonzero(look.bound > enough), len(self._path.walk)
        if places == 1:
            return
        row = np.repeat(rows, places * len(seconds))
        place = np.tile(np.repeat(np.arange(places), len(seconds)), len(rows))
        held = np.tile(seconds, len(rows) * places)
        hopeful = look.cost[row] + COSTS * held < enough
        row, place, held = row[hopeful], place[hopeful], held[hopeful]
        least = np.zeros((len(row), places))
        least[np.arange(len(row)), place] = held
        cost, times = self._held(look, row, least)
        useful = cost < np.minimum(look.bound[row], enough)
        self._attempts(look, row[useful], times[useful], enough, longer=longer)

    def _held(
        self, look: Look, row: Int[np.ndarray, "m"], least: Float[np.ndarray, "m trims"]
    ) -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m trims"]]:
        """Returns the best times, each at least so long, for the middles of boxes, and their cost."""
        cost, times = best_of_each(self._path.table(look.boxes.middle[row], least), self._mission)
        return cost, times + least

    def _attempts(
        self,
        look: Look,
        row: Int[np.ndarray, "m"],
        times: Float[np.ndarray, "m trims"],
        enough: float,
        *,
        longer: tuple[float, ...] = (),
    ) -> None:
        """Lets times answer in every way; where they become too short, tries longer ones."""
        for way in self._ways:
            use = self._can_answer(times, way) & (look.bound[row] > enough)
            trying, base = row[use], times[use]
            for share in (*longer, None):
                if not len(trying):
                    break
                closed = self._closed(look, trying, base, way)
                short = self._noted(look, trying, closed, way, base) & (look.bound[trying] > enough)
                if share is None or not way.answering or len(self._path.walk) == 1:
                    break
                least = np.zeros((int(short.sum()), base.shape[1]))
                for place in way.answering:
                    with np.errstate(all="ignore"):
                        reach = closed.times[place].reach
                    least[:, place] = np.minimum(share * reach[short], ESCAPES[-1])
                cost, base = self._held(look, trying[short], least)
                trying, base = trying[short][np.isfinite(cost)], base[np.isfinite(cost)]

    @staticmethod
    def _can_answer(times: Float[np.ndarray, "m trims"], way: Way) -> Bool[np.ndarray, "m"]:
        if not way.answering:
            return np.asarray(~times.any(axis=1))
        return np.asarray(times[:, way.answering].min(axis=1) > HELD)

    def _closed(
        self, look: Look, row: Int[np.ndarray, "m"], times: Float[np.ndarray, "m trims"], way: Way
    ) -> Closed:
        middle = look.boxes.middle[row]
        alone = way.turn is None and len(way.others) < 2
        goal = np.full(len(row), self._goal) if alone else self._path.at(middle).end(times)
        return close(
            self._path,
            middle,
            look.boxes.width[row],
            times,
            goal=goal,
            tolerance=self._mission.destination.reach,
            way=way,
        )

    def _noted(
        self,
        look: Look,
        row: Int[np.ndarray, "m"],
        closed: Closed,
        way: Way,
        times: Float[np.ndarray, "m trims"],
    ) -> Bool[np.ndarray, "m"]:
        """Keeps what is better; returns where only the sign of a time is amiss."""
        shortest = np.full(len(row), inf)
        # Numbers without bounds, where nothing holds, may overflow.
        with np.errstate(all="ignore"):
            for time in closed.times.values():
                shortest = np.minimum(shortest, time.low)
            holds = closed.holds & self._faces(closed)
            bound = np.where(holds & (shortest >= 0), closed.seconds.high, inf)
        # Of attempts that fail, those tell most whose times are short by least.
        held = times[:, way.answering].min(axis=1) if way.answering else np.zeros(len(row))
        fails = np.where(holds, FOREVER - shortest, 2 * FOREVER + look.dear * times.sum(axis=1) - held)
        rank = np.where(np.isfinite(bound), bound, fails)
        variables = look.boxes.middle.shape[1]
        # Rows may come more than once: the best comes last.
        for at in np.argsort(-rank, kind="stable"):
            if rank[at] < look.rank[row[at]]:
                look.rank[row[at]], look.blame[row[at]] = rank[at], closed.blame[at]
            if bound[at] < look.bound[row[at]]:
                look.bound[row[at]] = bound[at]
                toward = np.sign(closed.seconds.slope[at, :variables])
                look.corner[row[at]] = look.boxes.middle[row[at]] + toward * look.boxes.width[row[at]]
        return np.asarray(holds & (shortest < 0))

    def _faces(self, closed: Closed) -> Bool[np.ndarray, "m"]:
        """Returns where the heading at the end is as wanted."""
        mission = self._mission
        if mission.goal_heading is None or not wants_heading(mission):
            return np.ones(len(closed.holds), dtype=bool)
        wanted = mission.goal_heading - mission.start.heading
        off = np.array([abs(wrap_angle(one - wanted)) for one in closed.heading.middle.tolist()])
        allowed = mission.destination.heading_reach
        faces: Bool[np.ndarray, "m"] = off + closed.heading.reach <= allowed
        return faces
