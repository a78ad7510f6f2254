"""Arrival at a goal: one judgement for flight, log and scorecard."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isfinite, pi
from statistics import NormalDist

from .destination import Destination, Track, first_arrival


@dataclass(frozen=True, slots=True, eq=False)
class TrackSegment:
    """True track of one primitive, and whether arrival counts in it.

    Attributes:
        track: time since the start in seconds, north and east in metres, heading in radians (not wrapped).
        trim: id of the trim held; None in a maneuver.
        on_plan: False on a safe stop, after a replan that gave no plan, and where the vehicle was lost.
    """

    track: Track
    trim: int | None
    on_plan: bool = True


@dataclass(frozen=True, slots=True)
class ArrivalVerdict:
    """Judgement of a mission flight.

    Attributes:
        reached: True if the true track met position, heading and trim of the goal, on a plan, and the vehicle
            declared its arrival.
        declared: True if the vehicle ended its mission as arrived, by its estimate.
        time: seconds since the start of the first true arrival; None where not reached.
        closest: least true distance to the goal in metres, up to the arrival; None where nothing was flown.
        reason: why it was not reached; empty where it was.
    """

    reached: bool
    declared: bool
    time: float | None
    closest: float | None
    reason: str


def claims_arrival(
    track: Track,
    goal: Destination,
    *,
    position_sigma: float,
    heading_sigma: float,
    probability: float,
) -> bool:
    """Returns True where the vehicle may claim to be inside the goal.

    The claim holds with the stated probability for an error that is normal with the stated deviations,
    whatever their correlations. For a position margin of k deviations the probability outside is at most
    that of one number beyond k, the worst way to share the variance between two axes (Szekely and Bakirov
    2003, Extremal probabilities for Gaussian quadratic forms; proved for k > 1.24, so from 0.79 on). Position
    and heading share the rest alike (Boole).

    Args:
        track: as estimated.
        goal: position and heading with their tolerances.
        position_sigma: root of the summed variances of north and east, m.
        heading_sigma: standard deviation of the heading, rad.
        probability: of being inside, from 0, which trusts the estimate, to below 1.
    """
    risk = (1.0 - probability) / (2.0 if goal.wants_heading else 1.0)
    margin = NormalDist().inv_cdf(1.0 - risk / 2.0) if probability else 0.0
    tolerance, heading_tolerance = goal.tolerance - margin * position_sigma, goal.heading_tolerance
    if goal.wants_heading:
        heading_tolerance -= margin * heading_sigma
    if tolerance <= 0 or heading_tolerance < 0:
        return False
    sure = replace(goal, tolerance=tolerance, heading_tolerance=heading_tolerance)
    return first_arrival([track], sure).time is not None


def judge_arrival(
    segments: Sequence[TrackSegment], goal: Destination, *, trim: int | None, declared: bool
) -> ArrivalVerdict:
    """Judges a flight by its true track.

    Args:
        segments: of the flight, in order.
        goal: position and heading with their tolerances.
        trim: id of the trim wanted at the goal; None for any.
        declared: True if the vehicle declared its arrival.
    """
    counted = [part.track for part in segments if part.on_plan and trim in {None, part.trim}]
    met = first_arrival(counted, goal)
    if declared and met.time is not None:
        return ArrivalVerdict(True, True, met.time, met.closest, "")
    closest = first_arrival([part.track for part in segments], goal).closest
    if not isfinite(closest):
        return ArrivalVerdict(False, declared, None, None, "nothing was flown")
    return ArrivalVerdict(False, declared, None, closest, _reason(segments, goal, trim, declared, closest))


def _reason(
    segments: Sequence[TrackSegment], goal: Destination, trim: int | None, declared: bool, closest: float
) -> str:
    begin = "vehicle declared arrival, but " if declared else ""
    anywhere = replace(goal, heading=None, heading_tolerance=pi)
    if first_arrival([part.track for part in segments], anywhere).time is None:
        return f"{begin}the true miss was {closest:.2f} m" if declared else f"{closest:.2f} m at the closest"
    if first_arrival([part.track for part in segments], goal).time is None:
        return f"{begin}the goal was passed with another heading than wanted"
    if first_arrival([part.track for part in segments if trim in {None, part.trim}], goal).time is None:
        return f"{begin}the goal was passed in another trim than {trim}"
    if first_arrival([part.track for part in segments if part.on_plan], goal).time is None:
        return f"{begin}the goal was passed on a safe stop, not on a plan"
    return f"{begin}not on a plan and in trim {trim} at once" if declared else "arrival was not declared"
