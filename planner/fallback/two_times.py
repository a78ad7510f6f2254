"""The coasting times of two trims that close a walk on a point, in closed form.

With every other time given, holding a trim draws a line (yaw rate 0) or a circle; the walk closes where the
two meet. Of a circle only the first full turn counts: flying further round costs time and changes nothing.
"""

import numpy as np
from jaxtyping import Complex, Float

from .batch import Batch

Times = Float[np.ndarray, "rows trims"]
Pair = tuple[Float[np.ndarray, "rows"], Float[np.ndarray, "rows"]]

PARALLEL = 1e-9
"""Radians; lines that differ by less do not meet in a point worth computing."""

STRAIGHT = 1e-7
"""Radians per second; a slower turn is closed as a straight line, and then corrected on the true curve."""


def close(
    batch: Batch, times: Times, target: Complex[np.ndarray, "rows"], *, first: int, second: int
) -> Times:
    """Returns both ways to choose the times at two places so that the walk ends at the target.

    Args:
        batch: the walks, from the origin with heading 0.
        times: coasting times in seconds; those at the two places are ignored.
        target: where to end, north + i east in metres.
        first: place of the earlier trim.
        second: place of the later trim.

    Returns:
        Twice as many rows, the first ways before the second ways; not a number where there is no such way.
        Times may be negative on straight lines.
    """
    given = times.copy()
    given[:, [first, second]] = 0.0
    before, heading = batch.along(given, 0, first)
    middle, bend = batch.along(given, first + 1, second)
    tail, _ = batch.along(given, second + 1, batch.trims - 1)
    # Everything in the frame in which the earlier trim begins to coast.
    goal = (target - before) * np.exp(-1j * heading)
    onward = np.exp(1j * bend)
    turns_first = np.abs(batch.rate[:, first]) > STRAIGHT
    turns_second = np.abs(batch.rate[:, second]) > STRAIGHT
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        centre_first = np.where(turns_first, batch.velocity[:, first] / (1j * batch.rate[:, first]), 0)
        centre_second = np.where(turns_second, batch.velocity[:, second] / (1j * batch.rate[:, second]), 0)
        arm = centre_first + middle - onward * centre_second
        link = onward * (centre_second + tail)
        reach = goal + centre_first
        line_first, line_second = batch.velocity[:, first], onward * batch.velocity[:, second]
        both = turns_first & turns_second
        solutions = _circle_circle(arm, link, reach)
        line_circle = _line_circle(reach - arm, line_first, link)
        circle_line = _circle_line(arm + link, line_second, reach)
        line_line = _line_line(reach - arm - link, line_first, line_second)
        found = []
        for way in range(2):
            one = np.select(
                [both, turns_second, turns_first],
                [solutions[way][0], line_circle[way][0], circle_line[way][0]],
                line_line[0],
            )
            two = np.select(
                [both, turns_second, turns_first],
                [solutions[way][1], line_circle[way][1], circle_line[way][1]],
                line_line[1] if way == 0 else np.nan,
            )
            given[:, first] = np.where(turns_first, _turning_time(one, batch.rate[:, first]), one)
            given[:, second] = np.where(turns_second, _turning_time(two, batch.rate[:, second]), two)
            found.append(given.copy())
    return np.concatenate(found)


def _circle_circle(
    arm: Complex[np.ndarray, "rows"], link: Complex[np.ndarray, "rows"], reach: Complex[np.ndarray, "rows"]
) -> tuple[Pair, Pair]:
    """Solves exp(i a) (arm + exp(i b) link) = reach for the angles a and b."""
    elbow = np.conj(arm) * link
    size = np.abs(elbow)
    cosine = (np.abs(reach) ** 2 - np.abs(arm) ** 2 - np.abs(link) ** 2) / (2 * size)
    opening = np.arccos(_into_domain(cosine))
    pairs = []
    for angle in (opening - np.angle(elbow), -opening - np.angle(elbow)):
        pairs.append((np.angle(reach / (arm + np.exp(1j * angle) * link)), angle))
    return pairs[0], pairs[1]


def _line_circle(
    way: Complex[np.ndarray, "rows"], line: Complex[np.ndarray, "rows"], link: Complex[np.ndarray, "rows"]
) -> tuple[Pair, Pair]:
    """Solves line t + exp(i b) link = way for the time t and the angle b."""
    pairs = [(time, np.angle((way - line * time) / link)) for time in _meet(-way, line, np.abs(link))]
    return pairs[0], pairs[1]


def _circle_line(
    arm: Complex[np.ndarray, "rows"], line: Complex[np.ndarray, "rows"], reach: Complex[np.ndarray, "rows"]
) -> tuple[Pair, Pair]:
    """Solves exp(i a) (arm + line t) = reach for the angle a and the time t."""
    pairs = [(np.angle(reach / (arm + line * time)), time) for time in _meet(arm, line, np.abs(reach))]
    return pairs[0], pairs[1]


def _line_line(
    way: Complex[np.ndarray, "rows"], one: Complex[np.ndarray, "rows"], two: Complex[np.ndarray, "rows"]
) -> Pair:
    """Solves one t + two u = way for the times t and u."""
    area = _cross(one, two)
    area = np.where(np.abs(area) > PARALLEL * np.abs(one) * np.abs(two), area, np.nan)
    return _cross(way, two) / area, _cross(one, way) / area


def _meet(
    offset: Complex[np.ndarray, "rows"], line: Complex[np.ndarray, "rows"], radius: Float[np.ndarray, "rows"]
) -> Pair:
    """Solves |offset + line t| = radius for the time t, earlier and later."""
    speed = np.abs(line)
    middle = -(np.conj(line) * offset).real / speed**2
    nearest = np.abs(_cross(line, offset)) / speed
    square = radius**2 - nearest**2
    half = np.sqrt(np.where(square >= -1e-12 * radius**2, np.maximum(square, 0), np.nan)) / speed
    return middle - half, middle + half


def _nearest(offset: Complex[np.ndarray, "rows"], line: Complex[np.ndarray, "rows"]) -> Pair:
    """Returns, twice, when |offset + line t| is smallest."""
    time = -(np.conj(line) * offset).real / np.abs(line) ** 2
    return time, time


def meet_disc(
    batch: Batch, times: Times, target: Complex[np.ndarray, "rows"], tolerance: float, *, place: int
) -> Times:
    """Returns when, holding one trim, the walk's end enters or leaves a disc around the target.

    Args:
        batch: the walks, from the origin with heading 0.
        times: coasting times in seconds; the one at the place is ignored.
        target: centre of the disc, north + i east in metres.
        tolerance: radius of the disc in metres; 0 for the times at which the end may pass through its centre,
            which the caller has to look at.
        place: of the trim.

    Returns:
        Twice as many rows; not a number where the end never meets the circle.
    """
    given = times.copy()
    given[:, place] = 0.0
    before, heading = batch.along(given, 0, place)
    tail, _ = batch.along(given, place + 1, batch.trims - 1)
    goal = (target - before) * np.exp(-1j * heading)
    turns = np.abs(batch.rate[:, place]) > STRAIGHT
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        centre = np.where(turns, batch.velocity[:, place] / (1j * batch.rate[:, place]), 0)
        spoke, reach = centre + tail, goal + centre
        elbow = np.conj(spoke) * reach
        if tolerance == 0:
            opening = np.zeros(len(times))
            lines = _nearest(tail - goal, batch.velocity[:, place])
        else:
            cosine = (np.abs(reach) ** 2 + np.abs(spoke) ** 2 - tolerance**2) / (2 * np.abs(elbow))
            opening = np.arccos(_into_domain(cosine))
            lines = _meet(tail - goal, batch.velocity[:, place], np.full(len(times), tolerance))
        found = []
        for line, angle in zip(lines, (np.angle(elbow) - opening, np.angle(elbow) + opening), strict=True):
            given[:, place] = np.where(turns, _turning_time(angle, batch.rate[:, place]), line)
            found.append(given.copy())
    return np.concatenate(found)


def _turning_time(
    angle: Float[np.ndarray, "rows"], rate: Float[np.ndarray, "rows"]
) -> Float[np.ndarray, "rows"]:
    """Returns the first time, not negative, at which a turn has reached an angle (modulo full turns)."""
    period = 2 * np.pi / np.abs(rate)
    time = np.mod(angle / rate, period)
    return np.where(period - time < 1e-10 * period, 0.0, time)


def _into_domain(cosine: Float[np.ndarray, "rows"]) -> Float[np.ndarray, "rows"]:
    """Returns the cosine, rounding errors beyond 1 taken off; not a number where no angle has it."""
    return np.where(np.abs(cosine) <= 1 + 1e-12, np.clip(cosine, -1, 1), np.nan)


def _cross(one: Complex[np.ndarray, "rows"], two: Complex[np.ndarray, "rows"]) -> Float[np.ndarray, "rows"]:
    area: Float[np.ndarray, "rows"] = (np.conj(one) * two).imag
    return area
