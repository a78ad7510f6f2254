"""Tests of settling times and of the thesis's Table 10."""

from dataclasses import replace

import pytest

from experiments.campaign.fly_campaign import campaign_library, specify_campaign
from flight.se2 import Twist
from scenarios.find import find_campaign
from sim.checks.limits_check import check_limits
from sim.checks.response_check import check_response, check_table_10
from sim.control import maneuver_generator
from sim.control.gains import Gains
from sim.control.maneuver_generator import ManeuverGenerator, SecondOrderResponse
from sim.vehicle.parameters import read_parameters

CAMPAIGN = find_campaign("gtmax")
PRINTED, WINDY = (campaign_library(CAMPAIGN, wind) for wind in ("calm", "gtmax"))
FLIGHTS = specify_campaign(CAMPAIGN, WINDY, seed=2, flights=4, wind="gtmax")


def test_every_change_settles_in_its_time() -> None:
    figures = list(check_response(read_parameters()))
    assert len(figures) == 19
    assert [figure for figure in figures if not figure.passed] == []


def test_every_row_of_table_10_is_met() -> None:
    figures = list(check_table_10(PRINTED))
    judged = [figure for figure in figures if figure.limit_text]
    # Of 22 rows: 6 durations and 6 displacements of straight ones, all heading changes but 2 suspect.
    assert (len(figures), len(judged)) == (50, 32)
    assert [figure for figure in judged if not figure.passed] == []


def test_a_slower_response_misses_settling_times_and_table(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control of the response."""
    monkeypatch.setattr(
        maneuver_generator, "VELOCITY_RESPONSE", SecondOrderResponse(frequency=0.6, damping=0.76)
    )
    missed = [figure.name for figure in check_response(read_parameters()) if not figure.passed]
    assert missed
    assert all("speed" in name or "10 ft/s, 0.6" in name or "-0.6" in name for name in missed)
    straight = replace(PRINTED, maneuvers=PRINTED.maneuvers[:6])
    assert sum(not figure.passed for figure in check_table_10(straight)) >= 6


@pytest.mark.parametrize(("left", "reached"), [(7, 5), (5, 7)])
def test_only_a_turn_that_waits_for_its_speed_gives_the_heading_changes_of_table_10(
    left: int, reached: int
) -> None:
    row = PRINTED.maneuver(left, reached)
    before, after = PRINTED.trim(left).velocity, PRINTED.trim(reached).velocity

    def heading_change(start: Twist) -> float:
        generator = ManeuverGenerator(start, step=0.01)
        return sum(generator.step(after).yaw_rate.value * 0.01 for _ in range(round(row.duration * 100)))

    printed = row.displacement.heading
    assert heading_change(before) == pytest.approx(printed, rel=0.05)
    alone = replace(before, forward=after.forward)
    assert heading_change(alone) != pytest.approx(printed, rel=0.12)


def test_no_limit_is_met_in_the_librarys_maneuvers() -> None:
    figures = list(check_limits(FLIGHTS[:1], WINDY, read_parameters()))
    assert [figure for figure in figures if not figure.passed] == []


def test_limits_that_are_met_are_found() -> None:
    """Negative control: servos at a thirtieth of their rate, small tilt."""
    parameters = read_parameters()
    lame = replace(parameters, servos=replace(parameters.servos, rate=parameters.servos.rate / 30.0))
    tame = replace(Gains(), tilt_limit=0.05)
    for figures in (
        check_limits(FLIGHTS[:1], WINDY, lame),
        check_limits(FLIGHTS[:1], WINDY, parameters, gains=tame),
    ):
        lifted, *_ = figures
        assert lifted.value > 0.0
        assert not lifted.passed
