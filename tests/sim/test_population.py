"""Tests of drawn vehicles: who draws what, who believes what, and what logs say."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiments.campaign.fly_campaign import campaign_library, specify_campaign
from experiments.mission.repeat import repeat_flight
from flight.errors import BadFileError
from flightlog.attachment_names import VEHICLE_ATTACHMENT
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes, write_log
from flightlog.identity.fingerprint import fingerprint
from flightlog.log import FlightLog
from maneuver.app import run
from runtime.job import JobState
from scenarios.find import find_campaign
from sim.campaign_flight import CampaignFlight, fly_specification
from sim.loop.backend import Backend
from sim.loop.specification import FlightOptions, FlightSpecification, NoAirframeError
from sim.loop.streams import Stream, random_stream
from sim.population import vehicle_of
from sim.simulated_helicopter import SimulatedHelicopter
from sim.vehicle.parameters import read_parameters
from sim.vehicle.uncertainty import (
    LARGEST,
    VARIED,
    DrawnVehicle,
    differ,
    draw_vehicle,
    read_uncertainty,
    shipped_uncertainty,
    value_of,
    with_values,
)

NOMINAL = read_parameters()
LIBRARY = campaign_library(find_campaign("gtmax"), "gtmax")
SHORT = FlightSpecification(
    seed=3, wind="gtmax", start_trim=2, trims=(2, 3), coasting_times=(3.0, 3.0), settling_time=5.0
)
FLEET = SHORT.with_options(FlightOptions(vehicles="fleet"))


def one(airframe: int, seed: int) -> FlightSpecification:
    options = FlightOptions(vehicles="one", airframe_seed=airframe)
    return SHORT.model_copy(update={"seed": seed}).with_options(options)


@pytest.fixture(scope="module")
def flown() -> FlightLog:
    return fly_specification(FLEET, LIBRARY)


def test_the_nominal_vehicle_is_exact() -> None:
    assert vehicle_of(SHORT, NOMINAL) == DrawnVehicle(NOMINAL)
    assert fly_specification(SHORT, LIBRARY).header.drawn == ""


def test_one_airframe_keeps_what_is_built_and_draws_what_is_loaded() -> None:
    first, second, other = (
        dict(vehicle_of(flight, NOMINAL).differences) for flight in (one(7, 1), one(7, 2), one(8, 1))
    )
    loaded = {*shipped_uncertainty().flight.size, *shipped_uncertainty().flight.share}
    assert {name for name in first if first[name] != second[name]} == loaded
    assert {name for name in first if first[name] != other[name]} == set(first) - loaded


def test_every_flight_of_a_fleet_has_its_airframe() -> None:
    first, second = (
        dict(vehicle_of(FLEET.model_copy(update={"seed": seed}), NOMINAL).differences) for seed in (1, 2)
    )
    assert all(first[name] != second[name] for name in first)


def test_one_airframe_without_its_seed_is_refused() -> None:
    with pytest.raises(
        NoAirframeError, match="expected the seed of the airframe with vehicles 'one', got none"
    ):
        FlightOptions(vehicles="one")


def test_draws_have_the_stated_spread() -> None:
    uncertainty, count = shipped_uncertainty(), 2000
    drawn = [
        dict(draw_vehicle(NOMINAL, uncertainty, airframe=rng, flight=rng).differences)
        for rng in (random_stream(seed, Stream.AIRFRAME) for seed in range(count))
    ]
    # Standard deviation of a normal number cut at 2.5.
    cut = 0.955
    for level in (uncertainty.airframe, uncertainty.flight):
        for name, sigma in {**level.share, **level.size}.items():
            size = sigma * (abs(value_of(NOMINAL, name)) if name in level.share else 1.0)
            values = np.array([one[name] for one in drawn])
            # Five standard errors of a standard deviation of 2000 draws, and of a mean.
            assert values.std() == pytest.approx(cut * size, rel=5 / np.sqrt(2 * count)), name
            assert abs(values.mean()) < 5 * size / np.sqrt(count), name
            assert np.abs(values).max() <= LARGEST * size * (1 + 1e-12)


def test_every_drawn_vehicle_can_be_built() -> None:
    for seed in range(200):
        rng = random_stream(seed, Stream.AIRFRAME)
        body = draw_vehicle(NOMINAL, shipped_uncertainty(), airframe=rng, flight=rng).parameters.body
        inertia = np.array([[body.inertia_xx, -body.inertia_xz], [-body.inertia_xz, body.inertia_zz]])
        low, high = np.linalg.eigvalsh(inertia)
        moments = sorted((low, high, body.inertia_yy))
        assert moments[0] > 0
        assert moments[2] <= moments[0] + moments[1], "the triangle inequality of moments of inertia"


def test_a_moved_centre_of_mass_moves_everything_else_the_other_way() -> None:
    moved = differ(NOMINAL, {"centre_of_mass.forward": 0.03, "centre_of_mass.down": 0.01}).parameters
    assert moved.main_rotor.hub_forward == pytest.approx(-0.03)
    assert moved.main_rotor.hub_height == pytest.approx(NOMINAL.main_rotor.hub_height + 0.01)
    assert moved.tail_rotor.arm == pytest.approx(NOMINAL.tail_rotor.arm + 0.03)
    assert moved.body == NOMINAL.body


def test_the_plant_of_drawn_vehicles_is_the_plant_of_each() -> None:
    """The shared function with values, and the function of one vehicle alone."""
    drawn = vehicle_of(FLEET, NOMINAL)
    options = {"specification": SHORT, "library": LIBRARY, "backend": Backend.INTERPRETED}
    shared = SimulatedHelicopter(**options, flown=drawn)  # type: ignore[arg-type]
    alone = SimulatedHelicopter(**options, parameters=NOMINAL, flown=drawn)  # type: ignore[arg-type]
    from sim.vehicle.helicopter import Helicopter

    own = Helicopter(drawn.parameters)
    common = Helicopter(drawn.parameters, nominal=NOMINAL)
    for helicopter in (own, common):
        helicopter.restore(shared._initial_state)
        helicopter.signals.controls[:] = shared._signals.controls
        helicopter.run(200)
    np.testing.assert_allclose(common.signals.truth, own.signals.truth, atol=1e-9)
    assert alone.truth == shared.truth


@pytest.mark.parametrize("name", VARIED)
def test_every_varied_parameter_reaches_the_plant(name: str) -> None:
    from sim.vehicle.helicopter import Helicopter

    start = SimulatedHelicopter(SHORT, LIBRARY)._initial_state
    changed = with_values(NOMINAL, {name: value_of(NOMINAL, name) * 1.1 + 1e-3})
    ends = []
    for vehicle in (NOMINAL, changed):
        helicopter = Helicopter(vehicle, nominal=replace(NOMINAL, name="believed"))
        helicopter.restore(start)
        helicopter.signals.controls[:] = start.pending[0]
        helicopter.signals.controls[0] += 0.02
        helicopter.run(40)
        ends.append(helicopter.signals.truth.tolist())
    assert ends[0] != ends[1]


def test_a_log_says_what_was_drawn_and_what_is_believed(flown: FlightLog) -> None:
    drawn = vehicle_of(FLEET, NOMINAL)
    assert flown.header.vehicles == "fleet"
    assert flown.header.sensors == "rtk"
    assert flown.header.drawn == drawn.describe()
    believed = json.loads(flown.attachments[VEHICLE_ATTACHMENT])
    assert believed["body"]["mass"] == NOMINAL.body.mass != drawn.parameters.body.mass


def test_a_drawn_flight_is_replayed_bit_for_bit(flown: FlightLog, tmp_path: Path) -> None:
    path = tmp_path / "flown.mcap"
    write_log(flown, path)
    assert log_bytes(repeat_flight(read_log(path))) == log_bytes(flown)


def test_back_ends_fly_a_drawn_vehicle_alike(flown: FlightLog) -> None:
    interpreted = fly_specification(FLEET, LIBRARY, backend=Backend.INTERPRETED)
    assert fingerprint(interpreted) == fingerprint(flown)


def test_populations_are_different_flights(tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    write_log(fly_specification(one(7, 3), LIBRARY), path)
    states = [
        CampaignFlight(flight, LIBRARY, path).status()
        for flight in (one(7, 3), one(8, 3), FLEET, SHORT, FLEET.with_options(FlightOptions(sensors="gps")))
    ]
    assert [state.state for state in states] == [JobState.WHOLE, *[JobState.ANOTHER] * 4]


def test_a_campaign_of_a_fleet_flies_from_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "walk.mcap"
    words = ["fly", "--sequence", "slow-walk", "--vehicles", "one", "--airframe", "4", "--sensors", "gps"]
    assert run([*words, "--out", str(path)]) == 0
    assert read_log(path).header.vehicles == "airframe 4"
    assert read_log(path).header.sensors == "gps"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--vehicles", "fleet", "--airframe", "4"], "--airframe: expected --vehicles one, got"),
        (["--sensors", "loran"], "no sensor class 'loran'; there are ['gps', 'rtk']"),
    ],
)
def test_wrong_populations_are_refused(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["fly", "--sequence", "slow-walk", *words, "--out", str(tmp_path / "log.mcap")]) == 2
    assert said in capsys.readouterr().err


def test_a_spread_of_nothing_known_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "vehicle.toml"
    tables = "[uncertainty.{level}.share]\n[uncertainty.{level}.size]\n"
    path.write_text(tables.format(level="airframe") + '"body.colour" = 1.0\n' + tables.format(level="flight"))
    with pytest.raises(BadFileError, match=r"no parameter 'body.colour' is drawn; there are"):
        read_uncertainty(path)
    path.write_text("")
    with pytest.raises(BadFileError, match="expected a table uncertainty, got none"):
        read_uncertainty(path)


def test_flights_of_a_campaign_share_their_schedule_over_populations() -> None:
    campaign = find_campaign("gtmax")
    flights = specify_campaign(campaign, LIBRARY, seed=1, flights=2, wind="gtmax")
    drawn = [flight.with_options(FlightOptions(vehicles="fleet")) for flight in flights]
    assert [flight.sequence for flight in drawn] == [flight.sequence for flight in flights]
