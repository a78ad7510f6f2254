"""Tests of the reference model: settling time, closed form, derivatives."""

from math import cos, exp, sin, sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st

from flight.se2 import Twist
from sim.control.maneuver_generator import VELOCITY_RESPONSE, ManeuverGenerator, SecondOrderResponse

STEP = 0.01


def settling_time(values: list[float], *, start: float, end: float) -> float:
    outside = [i for i, value in enumerate(values) if abs(value - end) > 0.05 * abs(end - start)]
    return (outside[-1] + 2) * STEP


@given(start=st.floats(-5.0, 25.0), change=st.floats(0.1, 10.0), sign=st.sampled_from([-1.0, 1.0]))
def test_the_settling_time_is_the_same_for_every_change(start: float, change: float, sign: float) -> None:
    end = start + sign * change
    generator = ManeuverGenerator(Twist(start, 0.0, 0.0), step=STEP)
    values = [generator.step(Twist(end, 0.0, 0.0)).forward.value for _ in range(1000)]
    assert settling_time(values, start=start, end=end) == pytest.approx(4.08, abs=0.02)


@given(change=st.floats(0.1, 1.2))
def test_turns_settle_faster(change: float) -> None:
    generator = ManeuverGenerator(Twist(3.0, 0.0, 0.0), step=STEP)
    values = [generator.step(Twist(3.0, 0.0, change)).yaw_rate.value for _ in range(1000)]
    assert settling_time(values, start=0.0, end=change) == pytest.approx(3.00, abs=0.02)


@given(speeds=st.tuples(st.floats(0.0, 5.0), st.floats(6.0, 10.0)), turn=st.floats(0.1, 1.2))
def test_a_turn_takes_the_time_of_the_speed_that_changes_with_it(
    speeds: tuple[float, float], turn: float
) -> None:
    before, after = speeds
    generator = ManeuverGenerator(Twist(before, 0.0, 0.0), step=STEP)
    references = [generator.step(Twist(after, 0.0, turn)) for _ in range(1000)]
    for reference in references[::50]:
        speed_done = (reference.forward.value - before) / (after - before)
        assert reference.yaw_rate.value / turn == pytest.approx(speed_done, abs=1e-12)
    values = [generator.step(Twist(after, 0.0, 0.0)).yaw_rate.value for _ in range(1000)]
    assert settling_time(values, start=turn, end=0.0) == pytest.approx(3.00, abs=0.02)


@given(step=st.floats(0.001, 0.2))
def test_the_step_response_is_the_closed_form_at_any_step(step: float) -> None:
    frequency, damping = VELOCITY_RESPONSE.frequency, VELOCITY_RESPONSE.damping
    generator = ManeuverGenerator(Twist(0.0, 0.0, 0.0), step=step)
    for i in range(1, 30):
        time = i * step
        reference = generator.step(Twist(2.0, 0.0, 0.0)).forward
        swing = frequency * sqrt(1.0 - damping**2)
        decay = exp(-damping * frequency * time)
        left = decay * (cos(swing * time) + damping * frequency / swing * sin(swing * time))
        assert reference.value == pytest.approx(2.0 * (1.0 - left), abs=1e-12)
        assert reference.rate == pytest.approx(
            2.0 * frequency**2 / swing * decay * sin(swing * time), abs=1e-12
        )


def test_the_derivatives_are_the_derivatives() -> None:
    generator = ManeuverGenerator(Twist(0.0, 0.0, 0.0), step=1e-4)
    a, b, c = [generator.step(Twist(3.0, 0.0, 0.5)) for _ in range(5003)][-3:]
    assert (c.forward.value - a.forward.value) / 2e-4 == pytest.approx(b.forward.rate, rel=1e-6)
    assert (c.yaw_rate.rate - a.yaw_rate.rate) / 2e-4 == pytest.approx(b.yaw_rate.acceleration, rel=1e-3)


def test_a_trim_held_is_held_exactly() -> None:
    trim = Twist(3.048, 0.0, -0.6)
    generator = ManeuverGenerator(trim, step=STEP)
    for _ in range(1000):
        reference = generator.step(trim)
    assert (reference.forward.value, reference.side.value, reference.yaw_rate.value) == (3.048, 0.0, -0.6)
    assert (reference.forward.rate, reference.forward.acceleration) == (0.0, 0.0)


@pytest.mark.parametrize(("frequency", "damping"), [(0.0, 0.8), (-1.0, 0.8), (0.8, 1.0), (0.8, 0.0)])
def test_a_response_that_does_not_swing_is_refused(frequency: float, damping: float) -> None:
    with pytest.raises(ValueError, match="frequency must be > 0 rad/s and damping in"):
        SecondOrderResponse(frequency, damping)
