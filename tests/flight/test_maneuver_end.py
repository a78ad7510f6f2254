"""The rule by which a maneuver ends."""

import pytest

from flight.automaton.maneuver_end import Band, ManeuverEnd, ManeuverEndDetector, ManeuverStatus
from flight.se2 import Twist

TARGET = Twist(3.0, 0.0, 0.1)
RULE = ManeuverEnd({2: Band(0.2, 0.2, 0.02)}, dwell=0.5, timeout=5.0)
INSIDE = Twist(3.1, -0.1, 0.11)
OUTSIDE = Twist(3.3, 0.0, 0.1)


def make_detector() -> ManeuverEndDetector:
    return ManeuverEndDetector(RULE, to_trim=2, target=TARGET, entry_time=10.0)


def end_of(velocities: list[Twist], step: float = 0.1) -> tuple[float, ManeuverStatus]:
    """Returns judgement time after entry, and status, of a sample series."""
    under_test = make_detector()
    for place, velocity in enumerate(velocities):
        verdict = under_test.update(10.0 + place * step, velocity)
        if verdict is not ManeuverStatus.UNDER_WAY:
            return place * step, verdict
    return len(velocities) * step, ManeuverStatus.UNDER_WAY


def test_the_end_is_the_end_of_the_dwell() -> None:
    time, verdict = end_of([OUTSIDE] * 7 + [INSIDE] * 20)
    assert verdict is ManeuverStatus.ENDED
    assert time == pytest.approx(0.7 + RULE.dwell)


def test_leaving_the_band_starts_the_dwell_again() -> None:
    time, verdict = end_of([INSIDE] * 4 + [OUTSIDE] + [INSIDE] * 20)
    assert verdict is ManeuverStatus.ENDED
    assert time == pytest.approx(0.5 + RULE.dwell)


@pytest.mark.parametrize(
    "velocity", [Twist(3.21, 0.0, 0.1), Twist(3.0, -0.21, 0.1), Twist(3.0, 0.0, 0.121), Twist(3.0, 0.0, 0.0)]
)
def test_every_component_must_be_inside(velocity: Twist) -> None:
    assert end_of([velocity] * 40) == (4.0, ManeuverStatus.UNDER_WAY)


def test_a_maneuver_that_never_settles_times_out() -> None:
    time, verdict = end_of([OUTSIDE] * 100)
    assert verdict is ManeuverStatus.TIMED_OUT
    assert time == pytest.approx(RULE.timeout)


def test_a_dwell_that_ends_at_the_time_out_counts_as_settled() -> None:
    time, verdict = end_of([OUTSIDE] * 45 + [INSIDE] * 60)
    assert (round(time, 9), verdict) == (RULE.timeout, ManeuverStatus.ENDED)


def test_the_rate_of_the_samples_does_not_move_the_end() -> None:
    for step in (0.01, 0.02, 0.05):
        outside, inside = round(1.0 / step), round(2.0 / step)
        time, verdict = end_of([OUTSIDE] * outside + [INSIDE] * inside, step)
        assert verdict is ManeuverStatus.ENDED
        assert time == pytest.approx(1.0 + RULE.dwell)


def test_a_rule_that_nothing_can_meet_is_refused() -> None:
    with pytest.raises(ValueError, match="half widths of a band must be > 0"):
        Band(0.0, 1.0, 1.0)
    with pytest.raises(ValueError, match="dwell < timeout"):
        ManeuverEnd({}, dwell=2.0, timeout=1.0)
