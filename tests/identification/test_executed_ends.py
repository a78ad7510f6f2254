"""Ends of maneuvers: where the vehicle ended them, cut, or by a logged time-out."""

from dataclasses import replace

import numpy as np
import pytest

from experiments.mission.error_attribution import performances
from flightlog.log import FlightLog
from flightlog.primitives import flown_primitives
from flightlog.series import Series
from flightlog.topics import ESTIMATE, PRIMITIVE, TRUTH
from identification.segmentation.flight_evidence import extract_evidence
from identification.segmentation.segmentation import SegmentEnd, segment
from identification.statistics.samples import maneuver_samples
from tests.support.synthetic_log import BREEZE, synthetic_library, synthetic_log

LIBRARY = synthetic_library()
WALK, COASTS = (1, 3, 2, 1), (4.0, 0.0, 3.0, 2.0)
_TIMED_OUT = PRIMITIVE.field_names.index("timed_out")


def flown(seed: int = 3) -> FlightLog:
    return synthetic_log(LIBRARY, WALK, COASTS, seed=seed, noise=BREEZE)


def with_series(log: FlightLog, series: Series) -> FlightLog:
    return replace(log, series={**log.series, series.topic.name: series})


def commanded_early(log: FlightLog, *, place: int, by: float) -> FlightLog:
    """Returns the log with one command some seconds earlier."""
    series = log[PRIMITIVE]
    time = series.time.copy()
    time[place] -= by
    return with_series(log, replace(series, time=time))


def test_a_maneuver_ends_where_the_vehicle_ended_it_not_where_the_truth_settles() -> None:
    log = flown()
    ended = [part.end for part in flown_primitives(log) if part.kind == 1]
    segments = segment(log)
    assert [part.start + part.duration for part in segments.maneuvers] == pytest.approx(ended, abs=1e-9)
    assert all(part.end is SegmentEnd.SETTLED for part in segments.maneuvers)
    # Negative control: by the rule applied to the truth the ends are others.
    judged = segment(with_series(log, Series(ESTIMATE, log[TRUTH].time, log[TRUTH].values)))
    assert [part.duration for part in judged.maneuvers] != [part.duration for part in segments.maneuvers]


def test_deviations_are_of_the_true_motion_between_these_ends() -> None:
    log = flown()
    truth = log[TRUTH]
    part = segment(log).maneuvers[0]
    rows = [
        int(np.searchsorted(truth.time, time - 5e-7)) for time in (part.start, part.start + part.duration)
    ]
    turned = float(truth["heading"][rows[1]] - truth["heading"][rows[0]])
    assert part.displacement.heading == pytest.approx(turned, abs=1e-12)
    assert part.path[-1] == pytest.approx(
        (part.displacement.x, part.displacement.y, part.displacement.heading), abs=1e-9
    )
    assert part.path[0] == (0.0, 0.0, 0.0)


def test_a_maneuver_knows_the_one_before_and_the_coast_between() -> None:
    first, second, third = segment(flown()).maneuvers
    assert (first.previous, second.previous, third.previous) == (None, first.id, second.id)
    assert (first.coast, second.coast, third.coast) == pytest.approx((4.0, 0.0, 3.0), abs=1e-9)


def test_a_maneuver_cut_by_the_next_command_is_cut_not_timed_out() -> None:
    log = commanded_early(flown(), place=2, by=1.0)
    segments = segment(log)
    assert segments.maneuvers[0].end is SegmentEnd.CUT
    samples = maneuver_samples([extract_evidence(log, name="cut", sha256="0")], segments.maneuvers[0].id)
    assert (samples.count, samples.cut, samples.timeouts) == (0, 1, 0)
    cut = {one.id for one in performances(log) if one.kind == "maneuver"}
    assert segments.maneuvers[0].id not in cut
    assert segments.maneuvers[2].id in cut


def test_a_maneuver_cut_by_the_end_of_the_log_is_cut() -> None:
    log = synthetic_log(LIBRARY, (1, 3), (4.0, 0.0), seed=3, noise=BREEZE)
    until = log.duration - 1.0
    short = {
        name: replace(part, time=part.time[part.time <= until], values=part.values[part.time <= until])
        for name, part in log.series.items()
    }
    (part,) = segment(replace(log, series=short)).maneuvers
    assert part.end is SegmentEnd.CUT
    assert part.duration <= until - part.start


def test_only_a_logged_time_out_is_one() -> None:
    log = flown()
    series = log[PRIMITIVE]
    values = series.values.copy()
    # The row after the first maneuver says how that ended.
    values[2, _TIMED_OUT] = 1.0
    late = with_series(log, replace(series, values=values))
    assert segment(late).maneuvers[0].end is SegmentEnd.TIMED_OUT
    samples = maneuver_samples(
        [extract_evidence(late, name="late", sha256="0")], segment(late).maneuvers[0].id
    )
    assert (samples.timeouts, len(samples.discarded), samples.cut) == (1, 1, 0)
