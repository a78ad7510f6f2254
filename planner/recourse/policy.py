"""Policy with feedback: the best action by one look ahead."""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from jaxtyping import Bool, Float, Int

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.se2 import SE2, Twist

from .law import transition_law
from .problem import COASTS, STRAIGHT, Action
from .table import NO_SHIFT, CostTable

TABLE_ERROR = 0.05
"""Seconds that a maneuver must gain on a coast: less is within the table's error."""

DECISION_INTERVAL = COASTS[0]
"""Seconds of a coast after which is decided again."""

# Metres per second below which a trim leads nowhere.
_SLOWEST = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class States:
    """States of several flights.

    Attributes:
        trims: places of the trims.
        goals: forward and side of the goal as seen from the vehicle, in metres.
        coasted: seconds since the trim was entered.
        previous: ids of the maneuvers before; -1 where there was none.
        offset: believed velocity less the trim's command: m/s, m/s, rad/s.
    """

    trims: Int[np.ndarray, "n"]
    goals: Float[np.ndarray, "n 2"]
    coasted: Float[np.ndarray, "n"]
    previous: Int[np.ndarray, "n"]
    offset: Float[np.ndarray, "n 3"]


@dataclass(frozen=True, slots=True)
class Choice:
    """A decision of the policy.

    Attributes:
        maneuver: to perform; None to coast on.
        value: expected seconds to the goal.
        runner_up: the best action of the other kind, or else the next maneuver; None for a coast.
        runner_up_value: expected seconds to the goal by it; infinite where there is none.
    """

    maneuver: Maneuver | None
    value: float
    runner_up: Maneuver | None
    runner_up_value: float


class FeedbackPolicy:
    """Chooses actions by a table, without dithering and without endless coasts.

    A maneuver is chosen where it gains more than the table's error on the best coast. A turn lasts one full
    circle at most, and a trim that leads nowhere is left at once: without errors the state would come back.

    Args:
        library: the primitives.
        table: of the same library.
    """

    def __init__(self, library: Library, table: CostTable) -> None:
        self.library, self.table = library, table
        problem = table.problem
        self._first = problem.first
        self._maneuvers = {one.id: one for one in library.maneuvers}
        self._place = {trim: place for place, trim in enumerate(problem.trims)}
        self._velocity = np.array([law.mean for law in transition_law(library).trims])
        self._longest = np.array([_longest_coast(row) for row in self._velocity])
        self._leads_on = np.diff(self._first) > len(COASTS)

    def action(self, trim: int, choice: int) -> Action:
        """Returns an action of the trim at a place."""
        return self.table.problem.actions[int(self._first[trim]) + choice]

    def mean_velocity(self, trim: int) -> Twist:
        """Returns the mean velocity of the trim with an id."""
        return Twist(*self._velocity[self._place[trim]].tolist())

    def costs(self, states: States) -> Float[np.ndarray, "n actions"]:
        """Returns the expected seconds of every action, those not allowed infinite."""
        costs = self.table.action_costs(states.trims, states.goals, self._shifts(states))
        costs[self._over(states), : len(COASTS)] = inf
        return costs

    def choices(self, states: States) -> tuple[Int[np.ndarray, "n"], Float[np.ndarray, "n actions"]]:
        """Returns the chosen actions, and the expected seconds of all."""
        costs = self.costs(states)
        coasts = len(COASTS)
        row = np.arange(len(costs))
        coast = costs[:, :coasts].argmin(axis=1)
        if costs.shape[1] == coasts:
            return coast, costs
        maneuver = coasts + costs[:, coasts:].argmin(axis=1)
        return np.where(costs[row, maneuver] < costs[row, coast] - TABLE_ERROR, maneuver, coast), costs

    def decide(
        self,
        pose: SE2,
        trim: int,
        goal: tuple[float, float],
        *,
        coasted: float = 0.0,
        previous: int | None = None,
        offset: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> Choice:
        """Returns the action for a vehicle.

        Args:
            pose: believed, in the world.
            trim: id of the trim held.
            goal: north and east in metres.
            coasted: seconds since the trim was entered.
            previous: id of the maneuver before; None where there was none.
            offset: believed velocity less the trim's command: m/s, m/s, rad/s.

        Raises:
            UnknownTrimError: the library lacks the trim.
        """
        self.library.trim(trim)
        seen = pose.inverse() @ SE2(*goal, 0.0)
        states = States(
            np.array([self._place[trim]]),
            np.array([[seen.x, seen.y]]),
            np.array([coasted]),
            np.array([-1 if previous is None else previous]),
            np.array([offset]),
        )
        chosen, costs = self.choices(states)
        return self._choice(self._place[trim], int(chosen[0]), costs[0])

    def _choice(self, trim: int, chosen: int, costs: Float[np.ndarray, "actions"]) -> Choice:
        coasts = len(COASTS)
        others = costs.copy()
        if chosen < coasts:
            others[:coasts] = inf
        else:
            others[chosen] = inf
        second = int(others.argmin())
        named = [
            None if np.isinf(row[place]) else self.action(trim, place).maneuver
            for row, place in ((costs, chosen), (others, second))
        ]
        first, runner_up = (None if one is None else self._maneuvers[one] for one in named)
        return Choice(first, float(costs[chosen]), runner_up, float(others[second]))

    def _over(self, states: States) -> Bool[np.ndarray, "n"]:
        """Returns which coasts must end."""
        over = states.coasted > self._longest[states.trims] - 0.5 * DECISION_INTERVAL
        return np.asarray(over & self._leads_on[states.trims])

    def _shifts(self, states: States) -> Float[np.ndarray, "n actions 5"] | None:
        """Returns the shift of each maneuver's outcomes by its entry."""
        if all(one.law is None or one.law.entry is None for one in self._maneuvers.values()):
            return None
        shifts = np.tile(NO_SHIFT, (len(states.trims), self.table.most_actions, 1))
        for trim in np.unique(states.trims):
            rows = np.flatnonzero(states.trims == trim)
            for choice in range(len(COASTS), self._first[trim + 1] - self._first[trim]):
                number = self.action(trim, choice).maneuver
                if number is None:
                    continue
                off = entry_shift(self._maneuvers[number], states, rows)
                shifts[rows, choice, :3] = off[:, :3]
                shifts[rows, choice, 3], shifts[rows, choice, 4] = np.cos(off[:, 3]), np.sin(off[:, 3])
        return shifts


def entry_shift(maneuver: Maneuver, states: States, rows: Int[np.ndarray, "m"]) -> Float[np.ndarray, "m 4"]:
    """Returns the shift of a maneuver's mean values by its entry.

    Args:
        maneuver: about to be performed.
        states: of which some enter it.
        rows: of these.
    """
    law = maneuver.law
    if law is None or law.entry is None:
        return np.zeros((len(rows), 4))
    entry = law.entry
    before = {row.maneuver: row.shift for row in entry.previous}
    shift = np.array([before.get(one, (0.0,) * 4) for one in states.previous[rows].tolist()])
    faded = shift * np.exp(-states.coasted[rows] / entry.fade_time)[:, None]
    moved = states.offset[rows] @ np.array(entry.velocity).T
    return np.asarray(np.array(entry.base) + faded + moved - np.array(law.mean))


def _longest_coast(velocity: Float[np.ndarray, "3"]) -> float:
    """Returns the seconds after which a coast leads nowhere new."""
    if abs(velocity[2]) >= STRAIGHT:
        return float(2 * pi / abs(velocity[2]))
    return inf if np.hypot(velocity[0], velocity[1]) >= _SLOWEST else 0.0
