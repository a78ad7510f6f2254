"""Tests of `maneuver verify`: figures, limits and failures after damage."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from flight.se2 import Twist
from maneuver.app import run
from sim.checks.check_result import CheckResult
from sim.checks.vehicle_check import check_modes, check_shape, check_vehicle
from sim.vehicle.equilibrium import EquilibriumFinder
from sim.vehicle.parameters import read_parameters

PARAMETERS = read_parameters()


def test_the_vehicle_is_inside_every_limit() -> None:
    assert [figure for figure in check_vehicle(PARAMETERS) if not figure.passed] == []


def test_a_corrupt_parameter_is_found() -> None:
    """Negative control: 1 % more mass, or a soft hub."""
    heavy = replace(PARAMETERS, body=replace(PARAMETERS.body, mass=1.01 * PARAMETERS.body.mass))
    assert [figure.name for figure in check_shape(heavy) if not figure.passed] == ["mass, difference"]
    limp = replace(PARAMETERS, main_rotor=replace(PARAMETERS.main_rotor, hub_spring=0.01))
    missed = {figure.name for figure in check_modes(limp) if not figure.passed}
    assert {"roll, frequency", "pitch, damping"} <= missed


def test_a_figure_without_a_number_never_holds() -> None:
    assert not CheckResult("trim", "residual", float("nan"), "-", high=1.0).passed
    assert CheckResult("trim", "slow mode", 0.3, "1/s").passed


def test_the_command_prints_each_check_with_its_limit(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(("verify", "--topics", "modes", "trim", "--json")) == 0
    figures = json.loads(capsys.readouterr().out)["figures"]
    assert {figure["topic"] for figure in figures} == {"modes", "trim"}
    assert all(figure["holds"] for figure in figures)
    assert run(("verify", "--topics", "modes")) == 0
    assert "0 outside the limit" in capsys.readouterr().out


def test_the_ground_carries_a_part_of_the_rotor() -> None:
    hover = Twist(0.0, 0.0, 0.0)
    powers = [EquilibriumFinder(PARAMETERS, height=z).find(hover).power for z in (1.0, 2.0, 4.0, 30.0)]
    assert powers == sorted(powers)
    # With speed the ground's image is left behind.
    fast = Twist(10.0, 0.0, 0.0)
    near, free = (EquilibriumFinder(PARAMETERS, height=z).find(fast).power for z in (1.0, None))
    assert near > 0.99 * free


def test_the_spectra_are_drawn(tmp_path: Path) -> None:
    path = tmp_path / "spectrum.png"
    assert run(("verify", "--topics", "wind", "--spectrum", str(path), "--json")) == 0
    assert path.read_bytes().startswith(b"\x89PNG")


def test_a_topic_that_is_not_there_is_refused_by_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["verify", "--topics", "trim", "wnd"]) == 2
    said = capsys.readouterr().err
    assert "no topic wnd; the topics are trim, power" in said
    assert said.count("\n") == 1
