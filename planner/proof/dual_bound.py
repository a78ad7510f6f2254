"""Lagrangian lower bounds over boxes of coasting times.

Positions are complex (north + i east), seen from the start with heading 0. After the coast at place k the
heading that coasting has made is psi_k = psi_(k-1) + r_k t_k. A coast in a turn moves by
C_k (exp(i psi_k) - exp(i psi_(k-1))), a straight one by exp(i psi_k) W_k t_k, so the end of a walk is

    sum over the headings psi_j of exp(i psi_j) A_j,

and the coasting time itself is linear in headings and straight times. For any multipliers, a vector m in
seconds a metre and a number x_k for each place,

    kappa * cost >= kappa * fixed - Re(conj(m) goal) - |m| * tolerance
                    + sum_j min over psi_j of [a_j psi_j + Re(conj(m) A_j exp(i psi_j))] + ...

wherever the goal is reached (weak Lagrangian duality): one minimum of one variable for each heading, over the
interval that the box leaves it, each in closed form. At a turn x_k is worth that is shifted from the
coasting time to the headings; at a straight coast it is the time about which it is expanded. With kappa = 0
and a bound above 0 nothing in the box reaches the goal at all.
"""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Complex, Float, Int

from flight.mission.mission import Mission
from flight.se2 import rotate
from planner.walks.flow import fly_walks
from planner.walks.goal_condition import goal_from_start, wants_heading
from planner.walks.kinematics import WalkMotion

ROUNDING = 1e-12
"""Seconds (for kappa 0: metres) a second."""

POSITION_SLACK = 1e-4
"""Metres by which the end may shift if negligible turns are made straight."""

HEADING_SLACK = 1e-7
"""Radians, likewise, where a heading is wanted."""

PerTrim = Float[np.ndarray, "boxes trims"]
PerBox = Float[np.ndarray, "boxes"]


@dataclass(frozen=True, slots=True, eq=False)
class WalkProblems:
    """Walks at one level each, padded to a common length.

    Attributes:
        rate: yaw rates in radians per second.
        velocity: velocity of a trim in m/s, rotated by the maneuvers' turns.
        displacement: of the maneuver before each trim, likewise, metres.
        centre: of each turn; 0 for a straight trim.
        longest: seconds after which a turn repeats itself; infinite for a straight trim, 0 for one at rest.
        fixed: seconds in maneuvers.
        turned: heading change of the maneuvers, radians.
        goal: north + i east.
        tolerance: radius around it in metres, with the slack for rounding.
        heading: wanted at the goal, from the start's; None for any.
        heading_tolerance: half width around it in radians, with the slack for rounding.
        slack: for rounding, metres.
    """

    rate: PerTrim
    velocity: Complex[np.ndarray, "boxes trims"]
    displacement: Complex[np.ndarray, "boxes trims"]
    centre: Complex[np.ndarray, "boxes trims"]
    longest: PerTrim
    fixed: PerBox
    turned: PerBox
    goal: complex
    tolerance: float
    heading: float | None
    heading_tolerance: float
    slack: float

    @classmethod
    def of(cls, motions: list[WalkMotion], mission: Mission) -> "WalkProblems":
        """Returns the problems of walks for a mission."""
        trims = max(len(motion.velocities) for motion in motions)
        rows = [_merge_displacements(motion, trims) for motion in motions]
        rate, velocity, displacement = (np.array([row[part] for row in rows]) for part in range(3))
        with np.errstate(divide="ignore", invalid="ignore"):
            centre = np.where(rate != 0, velocity / (1j * rate), 0)
            longest = np.where(rate != 0, 2 * np.pi / np.abs(rate), np.where(velocity != 0, np.inf, 0.0))
        start = mission.start
        wanted = mission.goal_heading if wants_heading(mission) else None
        return cls(
            rate.real,
            velocity,
            displacement,
            centre,
            longest,
            np.array([motion.fixed_time for motion in motions], dtype=float),
            np.array([row[3] for row in rows]),
            goal_from_start(mission),
            mission.destination.reach,
            None if wanted is None else wanted - start.heading,
            mission.destination.heading_reach,
            mission.destination.slack,
        )

    def straightened(self, target: float) -> "WalkProblems":
        """Returns problems with negligible turns straightened and tolerances widened.

        If turns made straight turn by at most an angle, the end shifts by at most the walk's length times it.
        """
        if not np.isfinite(target):
            return self
        seconds = np.maximum(target - self.fixed, 0.0)[:, None]
        length = np.abs(self.displacement).sum(axis=1)[:, None]
        length = length + np.abs(self.velocity).max(axis=1)[:, None] * seconds
        angle = np.abs(self.rate) * seconds
        heading_slack = np.inf if self.heading is None else HEADING_SLACK
        slow = (self.rate != 0) & (angle * length <= POSITION_SLACK) & (angle <= heading_slack)
        moves = np.where(self.velocity != 0, np.inf, 0.0)
        return replace(
            self,
            rate=np.where(slow, 0.0, self.rate),
            centre=np.where(slow, 0.0, self.centre),
            longest=np.where(slow, moves, self.longest),
            tolerance=self.tolerance + float(np.where(slow, angle * length, 0.0).max(initial=0.0)),
            heading_tolerance=self.heading_tolerance + float(np.where(slow, angle, 0.0).max(initial=0.0)),
        )

    def take(self, rows: Int[np.ndarray, "taken"]) -> "WalkProblems":
        """Returns some of the problems, in the given order."""
        return WalkProblems(
            self.rate[rows],
            self.velocity[rows],
            self.displacement[rows],
            self.centre[rows],
            self.longest[rows],
            self.fixed[rows],
            self.turned[rows],
            self.goal,
            self.tolerance,
            self.heading,
            self.heading_tolerance,
            self.slack,
        )

    def propagate(
        self, times: PerTrim
    ) -> tuple[Complex[np.ndarray, "boxes trims"], Complex[np.ndarray, "boxes"], PerBox]:
        """Returns end velocities, ends and turns from coasting."""
        flow = fly_walks(self.velocity, self.rate, self.displacement, times)
        return flow.velocity, flow.end, flow.heading[:, -1]


def _merge_displacements(
    motion: WalkMotion, trims: int
) -> tuple[list[complex], list[complex], list[complex], float]:
    turned = 0.0
    rate: list[complex] = [0j] * trims
    velocity, displacement = [0j] * trims, [0j] * trims
    for place, twist in enumerate(motion.velocities):
        if place:
            moved = motion.displacements[place - 1]
            displacement[place] = complex(*rotate(moved.x, moved.y, turned))
            turned += moved.heading
        rate[place] = complex(twist.yaw_rate)
        velocity[place] = complex(*rotate(twist.forward, twist.side, turned))
    return rate, velocity, displacement, turned


@dataclass(frozen=True, slots=True, eq=False)
class Multipliers:
    """Multipliers that refute a box.

    Attributes:
        kappa: 1 for a bound of the cost, 0 where the goal is out of reach.
        vector: m, seconds per metre.
        shares: x, one for each trim: seconds per second at a turn, seconds at a straight coast.
    """

    kappa: PerBox
    vector: Complex[np.ndarray, "boxes"]
    shares: PerTrim


def dual_bound(problems: WalkProblems, low: PerTrim, high: PerTrim, by: Multipliers) -> PerBox:
    """Returns the Lagrangian lower bounds over boxes of coasting times."""
    m = np.conj(by.vector)
    total = by.kappa * problems.fixed - (m * problems.goal).real - problems.tolerance * np.abs(m)
    way, slope = np.zeros(len(low), dtype=complex), np.zeros(len(low))
    ends = headings(problems, low, high)
    before = np.zeros(len(low)), np.zeros(len(low))
    for place in range(low.shape[1]):
        turns = problems.rate[:, place] != 0
        x, first, last = by.shares[:, place], low[:, place], high[:, place]
        after = ends[0][:, place], ends[1][:, place]
        way = way + problems.displacement[:, place]
        gained = np.zeros(len(low))
        if turns.any():
            multiplier = (by.kappa - x) / np.where(turns, problems.rate[:, place], 1.0)
            least = least_wave(slope - multiplier, m * (way - problems.centre[:, place]), *before)
            gained = np.where(turns, least + np.minimum(x * first, x * np.where(turns, last, first)), gained)
            slope = np.where(turns, multiplier, slope)
        if not turns.all():
            speed = m * problems.velocity[:, place]
            still = np.zeros(len(low))
            steady = by.kappa + least_wave(still, speed, *after)
            fast = by.kappa - least_wave(still, -speed, *after)
            gained = np.where(turns, gained, by.kappa * x + _straight_term((first, last), x, (steady, fast)))
        with np.errstate(invalid="ignore"):
            total = total + gained
        way = np.where(turns, problems.centre[:, place], way + x * problems.velocity[:, place])
        before = after
    last = least_wave(slope, m * way, *before)
    # No wanted heading: the box is empty, whatever the weights of straight coasts.
    with np.errstate(invalid="ignore"):
        found: PerBox = np.where(last == np.inf, np.inf, total + last)
    return found


def _straight_term(times: tuple[PerBox, PerBox], x: PerBox, multiplier: tuple[PerBox, PerBox]) -> PerBox:
    """Returns the minimum over a box of a weighted straight-time term."""
    (first, last), (steady, fast) = times, multiplier
    with np.errstate(invalid="ignore"):
        late, early = (last - x) * steady, (first - x) * fast
    least: PerBox = np.minimum(np.where(steady < 0, late, 0.0), np.where(fast > 0, early, 0.0))
    # Outward rounding may make a zero weight negative on an unbounded interval.
    return np.where(np.isinf(last) & (steady < ROUNDING), -np.inf, least)


def headings(problems: WalkProblems, low: PerTrim, high: PerTrim) -> tuple[PerTrim, PerTrim]:
    """Returns heading intervals, the last intersected with the wanted one."""
    one, other = problems.rate * low, problems.rate * np.where(problems.rate == 0, 0.0, high)
    least, most = np.cumsum(np.minimum(one, other), axis=1), np.cumsum(np.maximum(one, other), axis=1)
    if problems.heading is None:
        return least, most
    wanted = problems.heading - problems.turned
    width = problems.heading_tolerance
    turn = 2 * np.pi
    first = wanted + turn * np.ceil((least[:, -1] - width - wanted) / turn) - width
    last = wanted + turn * np.floor((most[:, -1] + width - wanted) / turn) + width
    # Straight coasts after the last turn share its heading.
    tail = np.cumsum((problems.rate != 0)[:, ::-1], axis=1)[:, ::-1]
    final = (tail == 0) | ((tail == 1) & (problems.rate != 0))
    return (
        np.where(final, np.maximum(least, first[:, None]), least),
        np.where(final, np.minimum(most, last[:, None]), most),
    )


def least_wave(slope: PerBox, wave: Complex[np.ndarray, "boxes"], low: PerBox, high: PerBox) -> PerBox:
    """Returns the minimum of slope * psi + Re(wave exp(i psi))."""
    size = np.abs(wave)
    ends = [slope * psi + (wave * np.exp(1j * psi)).real for psi in (low, high)]
    least = np.minimum(*ends)
    bends = size > np.abs(slope)
    depth = np.sqrt(np.where(bends, size * size - slope * slope, 1.0))
    lowest = np.angle((-depth + 1j * slope) * np.conj(wave))
    turn = 2 * np.pi
    for psi in (
        lowest + turn * np.ceil((low - lowest) / turn),
        lowest + turn * np.floor((high - lowest) / turn),
    ):
        inside = bends & (psi >= low) & (psi <= high)
        # Not slope * psi - depth: of slow turns both are long, and the depth is the root of what cancels.
        there = slope * psi + (wave * np.exp(1j * psi)).real
        least = np.where(inside, np.minimum(least, there), least)
    found: PerBox = np.where(low > high, np.inf, least)
    return found
