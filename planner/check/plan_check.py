"""Check of a plan by repeating its flight, independent of the search."""

from cmath import exp
from dataclasses import replace
from math import hypot, inf, isfinite, pi, remainder, sin

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.automaton.maneuver import Maneuver
from flight.errors import FlightError
from flight.mission.destination import SLACK, slack_of
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from flight.se2 import Twist

from .certificate_check import certificate_problems, unproved_ends
from .committed_check import committed_problems

END_AGREEMENT = 1e3
"""Rounding slacks by which stated and recomputed ends may differ: 1e-6 m and rad, up to 1 km."""

OPTIMALITY = 2e-5
"""Seconds by which an optimal plan's cost may exceed its lower bound."""

PROVED_OPTIMALITY = 1e-3
"""Seconds likewise, where a certificate proves the bound, or branch and bound gave it."""


def plan_problems(plan: Plan, library: Library, mission: Mission) -> tuple[str, ...]:
    """Returns the faults of a plan; none for a valid one.

    Args:
        plan: the plan.
        library: the one it was planned with.
        mission: the one it was planned for.
    """
    found = identity_problems(plan, library_hash(library), library.name, mission)
    found += _gamma_problems(plan)
    if plan.at_smallest_tolerance is not None:
        found += _problems_at_wider_tolerance(plan.at_smallest_tolerance, library, mission)
    if not plan.found:
        return (*found, *_certificate_problems(plan, library, mission))
    try:
        maneuvers = library.maneuvers_along(plan.sequence)
        velocities = [library.trim(trim) for trim in plan.sequence]
    except FlightError as error:
        return (*found, f"sequence: {error}")
    found += _walk_problems(plan, maneuvers, mission)
    found += _safe_stop_problems(plan, library)
    for scenario in plan.scenarios:
        flown = [trim.at(scenario.gamma) for trim in velocities]
        found += [
            f"scenario gamma {scenario.gamma:g}: {problem}"
            for problem in _scenario_problems(scenario, flown, maneuvers, mission)
        ]
    if plan.lower_bound is not None and plan.lower_bound > plan.cost + slack_of(plan.cost):
        found.append(f"lower_bound: {plan.lower_bound} s is above the cost, {plan.cost} s")
    branched = plan.policy == "committed" or plan.certificate is not None
    gap = PROVED_OPTIMALITY if branched else OPTIMALITY
    if plan.status == "optimal" and not (plan.lower_bound or 0.0) >= plan.cost - gap:
        found.append(f"lower_bound: stated optimal at {plan.cost} s, but the bound is {plan.lower_bound} s")
    if plan.policy == "committed" and not found:
        found += committed_problems(plan, library, mission)
    # The certificate check takes longest: it runs only on otherwise valid plans.
    return tuple(found) or _certificate_problems(plan, library, mission)


def _certificate_problems(plan: Plan, library: Library, mission: Mission) -> tuple[str, ...]:
    """Returns the claims that a plan's certificate fails to prove."""
    if plan.certificate is None:
        return ()
    if plan.found == (plan.lower_bound is None):
        return ("certificate: proves a lower bound of a plan, or that there is none; got neither",)
    levels = tuple(sorted(_levels(plan)))
    bound = inf if plan.lower_bound is None else plan.lower_bound
    unproved = certificate_problems(plan.certificate, library, mission, gammas=levels, lower_bound=bound)
    return unproved + unproved_ends(plan, library, mission)


def _levels(plan: Plan) -> set[float]:
    return {0.0} if plan.policy == "nominal" else {0.0, -plan.gamma, plan.gamma}


def _problems_at_wider_tolerance(plan: Plan, library: Library, mission: Mission) -> list[str]:
    """Returns the faults of the plan at the smallest feasible tolerance."""
    if not (plan.found and plan.tolerance > mission.tolerance and plan.at_smallest_tolerance is None):
        return ["at_smallest_tolerance: expected a plan for a larger tolerance than the mission's"]
    wider = replace(mission, tolerance=plan.tolerance)
    return [f"at_smallest_tolerance: {problem}" for problem in plan_problems(plan, library, wider)]


def identity_problems(plan: Plan, hash_now: str, name: str, mission: Mission) -> list[str]:
    """Returns mismatches of a plan with this library and mission.

    Args:
        plan: the plan.
        hash_now: of the library.
        name: of the library.
        mission: the mission.
    """
    found = []
    if plan.library != name:
        found.append(f"library: planned with {plan.library}, not {name}")
    if plan.library_hash != hash_now:
        found.append(f"library_hash: planned with another library than this {name}")
    if plan.mission != mission.name:
        found.append(f"mission: planned for {plan.mission}, not {mission.name}")
    if plan.tolerance != mission.tolerance:
        found.append(f"tolerance: planned with {plan.tolerance} m, the mission has {mission.tolerance} m")
    return found


def _gamma_problems(plan: Plan) -> list[str]:
    """Returns mismatches between a plan's stated gamma and its scenarios."""
    found = _price_problems(plan)
    if plan.policy == "nominal" and plan.gamma != 0:
        found.append(f"gamma: nominal plans are for 0, got {plan.gamma}")
    if plan.policy != "committed" and plan.miss is not None:
        found.append(f"miss: {plan.policy} plans state none, got {plan.miss}")
    if not 0 <= plan.gamma <= 1:
        found.append(f"gamma: expected between 0 and 1, got {plan.gamma}")
    levels = _levels(plan)
    stated = [scenario.gamma for scenario in plan.scenarios]
    # A committed plan may show one level more: where it misses most.
    inside = [gamma for gamma in stated if plan.policy == "committed" and abs(gamma) < plan.gamma and gamma]
    shown = [gamma for gamma in stated if gamma not in inside[:1]]
    if plan.found and (set(shown) != levels or len(shown) != len(levels)):
        found.append(f"scenarios: expected one for each gamma of {sorted(levels)}, got {stated}")
    return found


def _price_problems(plan: Plan) -> list[str]:
    """Returns mismatches between a stated alpha and the plan's scenarios.

    The sequence at gamma 0 is a candidate for the nominal optimum.
    """
    if plan.policy != "price-of-robustness":
        return [] if plan.alpha is None else [f"alpha: {plan.policy} plans have none, got {plan.alpha}"]
    if plan.alpha is None or plan.alpha < 1:
        return [f"alpha: expected at least 1 of a price-of-robustness plan, got {plan.alpha}"]
    if plan.status == "optimal":
        return ["status: price-of-robustness plans are feasible, got optimal"]
    nominal = [scenario.cost for scenario in plan.scenarios if scenario.gamma == 0]
    if nominal and plan.cost > plan.alpha * nominal[0] + OPTIMALITY:
        paid = plan.cost / nominal[0] if nominal[0] > 0 else inf
        return [f"alpha: the scenarios need at least {paid:.6g}, got {plan.alpha:g}"]
    return []


def _walk_problems(plan: Plan, maneuvers: tuple[Maneuver, ...], mission: Mission) -> list[str]:
    found = []
    if not plan.sequence or plan.sequence[0] != mission.start_trim:
        found.append(
            f"sequence: the mission starts in trim {mission.start_trim}, the plan is {plan.sequence}"
        )
    elif mission.goal_trim not in (None, plan.sequence[-1]):
        found.append(f"sequence: the mission ends in trim {mission.goal_trim}, the plan is {plan.sequence}")
    if len(plan.sequence) > mission.max_trims:
        found.append(f"sequence: at most {mission.max_trims} trims, got {len(plan.sequence)}")
    joined = tuple(maneuver.id for maneuver in maneuvers)
    if plan.maneuvers != joined:
        found.append(f"maneuvers: the library joins the trims by {joined}, got {plan.maneuvers}")
    return found


def _safe_stop_problems(plan: Plan, library: Library) -> list[str]:
    """Returns the faults of a plan's safe-stop path.

    Committed plans need not carry one.
    """
    if not plan.tail:
        missing = plan.policy != "committed" and _fails_to_rest(plan.sequence[-1], library)
        return [f"tail: missing, though trim {plan.sequence[-1]} has a safe stop"] if missing else []
    try:
        library.maneuvers_along((plan.sequence[-1], *plan.tail))
        end = library.trim(plan.tail[-1]).velocity
    except FlightError as error:
        return [f"tail: {error}"]
    speeds = {trim.id: hypot(trim.velocity.forward, trim.velocity.side) for trim in library.trims}
    straight = [trim.id for trim in library.trims if trim.velocity.yaw_rate == 0] or list(speeds)
    slowest = min(speeds[trim] for trim in straight)
    if plan.tail[-1] in straight and hypot(end.forward, end.side) <= slowest:
        return []
    return [f"tail: ends in trim {plan.tail[-1]}, which is no rest trim: one at {slowest:g} m/s is slower"]


def _fails_to_rest(trim: int, library: Library) -> bool:
    """Returns True if a better rest trim is reachable from this trim."""
    speeds = {one.id: hypot(one.velocity.forward, one.velocity.side) for one in library.trims}
    turning = {one.id: one.velocity.yaw_rate != 0 for one in library.trims}
    rest = min(speeds, key=lambda one: (turning[one], speeds[one], one))
    reached = {trim}
    for _ in library.trims:
        reached |= {step.to_trim for step in library.maneuvers if step.from_trim in reached}
    return trim != rest and rest in reached


def _scenario_problems(
    scenario: Scenario, velocities: list[Twist], maneuvers: tuple[Maneuver, ...], mission: Mission
) -> list[str]:
    times = scenario.coasting_times
    if len(times) != len(velocities):
        return [f"coasting_times: one for each of {len(velocities)} trims, got {len(times)}"]
    if not all(isfinite(time) and time >= 0 for time in times):
        return [f"coasting_times: must be >= 0 s, got {times}"]
    outcomes = [maneuver.at(scenario.gamma) for maneuver in maneuvers]
    durations = [outcome.duration for outcome in outcomes]
    found = [f"a maneuver lasts {duration} s" for duration in durations if duration < 0]
    total = sum(times) + sum(durations)
    if not abs(total - scenario.cost) <= slack_of(total):
        found.append(f"cost: the parts sum to {total} s, stated is {scenario.cost} s")
    position, heading = complex(mission.start.x, mission.start.y), mission.start.heading
    for place, (velocity, time) in enumerate(zip(velocities, times, strict=True)):
        if place:
            moved = outcomes[place - 1].displacement
            position += exp(1j * heading) * complex(moved.x, moved.y)
            heading += moved.heading
        position += exp(1j * heading) * _chord(velocity, time)
        heading += velocity.yaw_rate * time
    return found + _end_problems(scenario, position, heading, mission)


def _end_problems(scenario: Scenario, position: complex, heading: float, mission: Mission) -> list[str]:
    found = []
    distance = abs(position - complex(scenario.end.x, scenario.end.y))
    turned = abs(_turn(heading - scenario.end.heading))
    if not (distance <= END_AGREEMENT * mission.destination.slack and turned <= END_AGREEMENT * SLACK):
        found.append(f"end: recomputed, it is {distance:.3g} m from the stated end")
    miss = abs(position - complex(*mission.goal))
    if not miss <= mission.destination.reach:
        found.append(f"goal: missed by {miss:.6g} m, allowed {mission.tolerance} m")
    if mission.goal_heading is not None:
        off = abs(_turn(heading - mission.goal_heading))
        if not off <= mission.destination.heading_reach:
            found.append(f"goal heading: off by {off:.6g} rad, allowed {mission.heading_tolerance} rad")
    return found


def _chord(velocity: Twist, time: float) -> complex:
    """Returns the chord of a coast, at half its heading change."""
    half = 0.5 * velocity.yaw_rate * time
    shrunk = sin(half) / half if half else 1.0
    return complex(velocity.forward, velocity.side) * time * shrunk * exp(1j * half)


def _turn(angle: float) -> float:
    return remainder(angle, 2 * pi)
