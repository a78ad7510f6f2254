"""Flight logs from the reference model with noise, without a simulator.

The truth is known in closed form, for tests of identification and review: velocities are the second-order
response to each change of trim plus correlated noise, positions are their exact planar integral, and
primitives end by the rule of `flight.automaton.maneuver_end` applied to the estimate.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.signal import lfilter

from flight.automaton.conditions import Conditions
from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.maneuver_end import Band, ManeuverEnd, ManeuverEndDetector, ManeuverStatus
from flight.automaton.sign_convention import signed_maneuver_error, signed_trim_error
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind
from flightlog.series import Series
from flightlog.topics import COMMAND, ESTIMATE, PRIMITIVE, TRUTH, WIND

from .reference_model import STEP, at_rest, integrate, reference_response

ALTITUDE = 30.0
"""Metres above ground."""

# Thesis, Tables 3 and 10: body velocities in m/s (from ft/s) and rad/s; the pairs of trims that are joined.
FOOT = 0.3048
TRIMS = {
    1: ("hover", Twist(0.0, 0.0, 0.0)),
    2: ("slow forward", Twist(3 * FOOT, 0.0, 0.0)),
    3: ("fast forward", Twist(10 * FOOT, 0.0, 0.0)),
    4: ("slow left turn", Twist(3 * FOOT, 0.0, -0.1)),
    5: ("slow right turn", Twist(3 * FOOT, 0.0, 0.1)),
    6: ("fast left turn", Twist(10 * FOOT, 0.0, -0.6)),
    7: ("fast right turn", Twist(10 * FOOT, 0.0, 0.6)),
}
EDGES = (
    *((2, 1), (1, 2), (1, 3), (3, 1), (3, 2), (2, 3), (4, 2), (2, 4), (2, 5), (5, 2), (4, 5)),
    *((5, 4), (6, 3), (3, 6), (3, 7), (7, 3), (6, 7), (7, 6), (7, 5), (5, 7), (6, 4), (4, 6)),
)


@dataclass(frozen=True, slots=True)
class FlightNoise:
    """Standard deviations of a synthetic flight's stationary noise.

    Attributes:
        motion: true velocity around the command.
        estimate: estimated velocity around the true one.
        position: estimated position around the true one, metres in each axis.
        correlation_time: correlation time of all of them, seconds.
    """

    motion: Twist
    estimate: Twist
    position: float
    correlation_time: float = 2.0


BREEZE = FlightNoise(Twist(0.06, 0.06, 0.006), Twist(0.02, 0.02, 0.002), 0.3)
"""Light noise: trims are held to a quarter of a metre per second."""

STILL = FlightNoise(Twist(0.0, 0.0, 0.0), Twist(0.0, 0.0, 0.0), 0.0)
"""No noise: truth and estimate equal the command."""


@dataclass(frozen=True, slots=True, eq=False)
class _NoiseSamples:
    """Noise samples for the longest possible flight."""

    motion: Float[np.ndarray, "n 3"]
    estimate: Float[np.ndarray, "n 3"]
    position: Float[np.ndarray, "n 3"]
    height: Float[np.ndarray, "n"]
    gust: Float[np.ndarray, "n 3"]


def synthetic_library() -> Library:
    """Returns the reference model's 7 trims and 22 maneuvers.

    They are those of the GTMax in still air.
    """
    trims = tuple(
        Trim(number, name, velocity, signed_trim_error(Twist(0.25, 0.25, 0.03), velocity))
        for number, (name, velocity) in TRIMS.items()
    )
    rule = ManeuverEnd({number: Band(0.3, 0.3, 0.04) for number in TRIMS}, dwell=0.5, timeout=15.0)
    return Library(
        name="synthetic",
        description="The trims of the GTMax joined by a second-order reference model.",
        vehicle="reference model",
        trims=trims,
        maneuvers=tuple(_maneuver(number, edge, rule) for number, edge in enumerate(EDGES, start=1)),
        conditions=Conditions("calm", ALTITUDE, rule, "instantaneous"),
    )


def synthetic_log(
    library: Library,
    trims: Sequence[int],
    coasting_times: Sequence[float],
    *,
    seed: int,
    noise: FlightNoise = BREEZE,
    start: SE2 | None = None,
    kind: str = "sequence",
    name: str = "synthetic",
) -> FlightLog:
    """Flies a walk through a library on the reference model.

    Args:
        library: trims, edges and maneuver-end rule; displacements are not used.
        trims: ids of the walk, the first held at time 0.
        coasting_times: seconds in each trim.
        seed: seed of the noise.
        noise: standard deviations; `STILL` for none.
        start: pose at time 0; the origin, heading north, if None.
        kind: kind of flight in the header.
        name: name in the header.

    Returns:
        Command, estimate, truth, wind and primitives at 50 Hz; the library is attached.
    """
    rule = library.conditions.maneuver_end
    if rule is None:
        raise ValueError(f"library {library.name} has no maneuver-end rule")
    library.maneuvers_along(trims)
    longest = round(sum(coasting_times) / STEP) + len(trims) * (round(rule.timeout / STEP) + 2) + 1
    noises = _draw(noise, longest, seed)
    response, rows = _fly(library, rule, trims, coasting_times, noises.motion + noises.estimate)
    series = _series(response, noises, start or SE2.identity())
    primitives = np.array(rows)
    header = FlightHeader(kind, name, "reference model", "0" * 64, seed, "calm", "0", "reference model")
    return FlightLog(
        header=header,
        series={
            **{part.topic.name: part for part in series},
            PRIMITIVE.name: Series(PRIMITIVE, primitives[:, 0], primitives[:, 1:]),
        },
        attachments={LIBRARY_ATTACHMENT: library_text(library).encode()},
    )


def _maneuver(number: int, edge: tuple[int, int], rule: ManeuverEnd) -> Maneuver:
    """Returns the noiseless maneuver between two trims, with rounded errors."""
    (_, before), (_, after) = TRIMS[edge[0]], TRIMS[edge[1]]
    response = reference_response(at_rest(before), after, round(rule.timeout / STEP) + 1)[0]
    ticks = _ending(rule, edge[1], after, 0.0, response)[0]
    pose = integrate(response[: ticks + 1], SE2.identity())[-1]
    error = signed_maneuver_error(ManeuverError(0.6, 0.6, 0.4, 0.08), left=before, reached=after)
    displacement = SE2(float(pose[0]), float(pose[1]), float(pose[2]))
    return Maneuver(number, *edge, duration=ticks * STEP, displacement=displacement, error=error)


def _fly(
    library: Library,
    rule: ManeuverEnd,
    trims: Sequence[int],
    coasting_times: Sequence[float],
    deviation: Float[np.ndarray, "n 3"],
) -> tuple[Float[np.ndarray, "n 3"], list[list[float]]]:
    """Returns the response at every tick and the rows of `/primitive`.

    Args:
        library: trims and edges.
        rule: maneuver-end rule, applied to response plus deviation.
        trims: trim ids of the walk.
        coasting_times: seconds in each trim.
        deviation: deviation of the estimate from the response.
    """
    first = library.trim(trims[0])
    rows = [_row(0.0, PrimitiveKind.COAST, first.id, (first, first))]
    pieces, state, tick = [], at_rest(first.velocity), 0
    piece, state = reference_response(state, first.velocity, round(coasting_times[0] / STEP))
    pieces.append(piece)
    tick += len(piece)
    for edge, coasting_time in zip(pairwise(trims), coasting_times[1:], strict=True):
        before, after = library.trim(edge[0]), library.trim(edge[1])
        rows.append(_row(_seconds(tick), PrimitiveKind.MANEUVER, library.maneuver(*edge).id, (before, after)))
        ahead, _ = reference_response(state, after.velocity, round(rule.timeout / STEP) + 1)
        estimate = ahead + deviation[tick : tick + len(ahead)]
        ticks, status = _ending(rule, after.id, after.velocity, _seconds(tick), estimate)
        late = status is ManeuverStatus.TIMED_OUT
        rows.append(_row(_seconds(tick + ticks), PrimitiveKind.COAST, after.id, (after, after), late=late))
        piece, state = reference_response(state, after.velocity, ticks + round(coasting_time / STEP))
        pieces.append(piece)
        tick += len(piece)
    pieces.append(state[None, 0])
    return np.concatenate(pieces), rows


def _seconds(tick: int) -> float:
    """Returns a tick's time in whole nanoseconds, as in files."""
    return round(tick * STEP * 1e9) * 1e-9


def _row(
    time: float, kind: PrimitiveKind, number: int, trims: tuple[Trim, Trim], *, late: bool = False
) -> list[float]:
    before, after = trims
    velocity = after.velocity
    return [
        *(time, kind, number, before.id, after.id),
        *(velocity.forward, velocity.side, velocity.yaw_rate, late),
    ]


def _ending(
    rule: ManeuverEnd, to_trim: int, target: Twist, entry_time: float, velocity: Float[np.ndarray, "n 3"]
) -> tuple[int, ManeuverStatus]:
    """Returns number of ticks and status at a maneuver's end."""
    detector = ManeuverEndDetector(rule, to_trim=to_trim, target=target, entry_time=entry_time)
    for ticks, (forward, side, yaw_rate) in enumerate(velocity.tolist()):
        status = detector.update(entry_time + ticks * STEP, Twist(forward, side, yaw_rate))
        if status is not ManeuverStatus.UNDER_WAY:
            return ticks, status
    raise AssertionError("the rule's time-out ends every maneuver")


def _draw(noise: FlightNoise, count: int, seed: int) -> _NoiseSamples:
    rng = np.random.default_rng(seed)
    moving = noise != STILL
    sizes = [
        *(noise.motion.forward, noise.motion.side, noise.motion.yaw_rate),
        *(noise.estimate.forward, noise.estimate.side, noise.estimate.yaw_rate),
        *(noise.position, noise.position, noise.position),
        *(0.3 * moving, 0.6 * moving, 0.6 * moving, 0.3 * moving),
    ]
    keep = np.exp(-STEP / noise.correlation_time)
    white = rng.standard_normal((count, len(sizes))) * np.sqrt(1 - keep**2)
    # Starts from the stationary distribution, without a transient.
    white[0] /= np.sqrt(1 - keep**2)
    drawn = np.asarray(lfilter([1.0], [1.0, -keep], white, axis=0)) * np.array(sizes)
    return _NoiseSamples(drawn[:, 0:3], drawn[:, 3:6], drawn[:, 6:9], drawn[:, 9], drawn[:, 10:13])


def _series(response: Float[np.ndarray, "n 3"], noises: _NoiseSamples, start: SE2) -> list[Series]:
    count = len(response)
    time = np.array([_seconds(tick) for tick in range(count)])
    velocity = response + noises.motion[:count]
    poses = integrate(velocity, start)
    down = -(ALTITUDE + noises.height[:count])
    # Coordinated flight: the tilt follows from the accelerations along and across the path.
    pitch = -np.gradient(response[:, 0], STEP) / 9.81
    roll = np.arctan2(velocity[:, 0] * velocity[:, 2], 9.81)
    position = [poses[:, :2], down, velocity[:, :2], np.gradient(down, STEP)]
    rates = [np.gradient(roll, STEP), np.gradient(pitch, STEP), velocity[:, 2], velocity[:, 2]]
    truth = np.column_stack([*position, roll, pitch, poses[:, 2], *rates])
    estimate = truth.copy()
    estimate[:, 0:3] += noises.position[:count]
    estimate[:, [3, 4, 12]] += noises.estimate[:count]
    command = np.column_stack([response, np.full(count, ALTITUDE)])
    mean_wind = np.array([1.5, -0.8, 0.0]) if noises.gust.any() else np.zeros(3)
    air = np.column_stack([mean_wind + noises.gust[:count], np.zeros((count, 3))])
    parts = ((COMMAND, command), (ESTIMATE, estimate), (TRUTH, truth), (WIND, air))
    return [Series(topic, time, values) for topic, values in parts]
