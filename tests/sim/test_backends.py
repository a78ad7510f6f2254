"""Tests of the numeric back-ends: same bits interpreted and compiled."""

from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from experiments.campaign.fly_campaign import campaign_library
from flight.automaton.library import Library
from flight.mission.fault import parse_fault
from flightlog.identity.fingerprint import fingerprint, rounded_fingerprint
from flightlog.log import FlightLog
from flightlog.topics import TRUTH
from runtime import compiler as machine_code
from runtime.compiler import NoMachineCodeError, shared_library
from scenarios.find import find_campaign
from sim.campaign_flight import fly_sequence
from sim.loop import backend as backends
from sim.loop.backend import (
    Backend,
    BitMismatchError,
    best_backend,
    name_backend,
    prepare_function,
    same_bits,
)
from sim.loop.specification import FlightSpecification
from sim.replay import VehicleMismatchError
from sim.simulated_helicopter import SimulatedHelicopter
from tests.support.commands_flown import replay

HAS_COMPILER = best_backend() is Backend.COMPILED
needs_compiler = pytest.mark.skipif(not HAS_COMPILER, reason="there is no C compiler that works")


def library() -> Library:
    return campaign_library(find_campaign("gtmax"), "gtmax")


def fly(backend: Backend | None, *, ideal: bool = False) -> FlightLog:
    words = ["wind gust 2 1 0 3 0", "pedal slow 5 3 0.5"] + ([] if ideal else ["gps dropout 6 2"])
    flight = FlightSpecification(
        seed=3,
        wind="gtmax",
        ideal_navigation=ideal,
        faults=tuple(map(parse_fault, words)),
        start_trim=1,
        trims=(1, 3, 7),
        coasting_times=(4.0, 3.0, 5.0),
    )
    helicopter = SimulatedHelicopter(flight, library(), backend=backend)
    fly_sequence(helicopter, flight.sequence, library=library())
    return helicopter.log()


@needs_compiler
@pytest.mark.parametrize("ideal", [False, True])
def test_a_flight_has_the_same_bits_interpreted_and_compiled(ideal: bool) -> None:
    interpreted, compiled = (fly(backend, ideal=ideal) for backend in Backend)
    assert interpreted.series.keys() == compiled.series.keys()
    for name, series in interpreted.series.items():
        assert series.time.tobytes() == compiled.series[name].time.tobytes()
        assert series.values.tobytes() == compiled.series[name].values.tobytes()
    assert fingerprint(interpreted) == fingerprint(compiled)
    assert interpreted.header.backend.endswith("interpreted")
    assert compiled.header.backend.endswith("compiled")


def test_a_fingerprint_depends_on_every_other_change() -> None:
    log = fly(Backend.INTERPRETED, ideal=True)
    truth = log.series["/truth"]
    moved = truth.values.copy()
    moved[-1, 0] = np.nextafter(moved[-1, 0], np.inf)
    for other in (
        replace(log, header=replace(log.header, seed=4)),
        replace(log, header=replace(log.header, backend="casadi-0.0.0 interpreted")),
        replace(log, series={**log.series, "/truth": replace(truth, values=moved)}),
        replace(log, attachments={**log.attachments, "more": b""}),
    ):
        assert fingerprint(other) != fingerprint(log)


def test_a_rounded_fingerprint_sees_another_flight_and_no_last_bit() -> None:
    log = fly(Backend.INTERPRETED, ideal=True)
    truth = log.series["/truth"]

    def moved(factor: float) -> FlightLog:
        return replace(log, series={**log.series, "/truth": replace(truth, values=truth.values * factor)})

    assert rounded_fingerprint(moved(1 + 1e-13)) == rounded_fingerprint(log)
    for other in (
        moved(1 + 1e-4),
        replace(log, header=replace(log.header, seed=4)),
        replace(log, header=replace(log.header, outcome="in the ground")),
    ):
        assert rounded_fingerprint(other) != rounded_fingerprint(log)


@needs_compiler
def test_a_compiled_flight_is_replayed_by_its_own_backend_and_refused_without_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    log = fly(Backend.COMPILED, ideal=True)
    flown = log[TRUTH].values
    assert replay(log)[::2].tobytes() == flown[: len(flown) - 1].tobytes()
    monkeypatch.setattr("sim.replay.best_backend", lambda: Backend.INTERPRETED)
    with pytest.raises(
        VehicleMismatchError, match=r"numeric back-end of the log, casadi-\S+ compiled, got cas"
    ):
        replay(log)


def test_without_a_compiler_the_back_end_is_interpreted_and_named_so(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(machine_code, "COMPILERS", ("no-such-compiler",))
    monkeypatch.setattr(machine_code, "WHEEL", "no_such_wheel")
    best_backend.cache_clear()
    prepare_function.cache_clear()
    try:
        assert best_backend() is Backend.INTERPRETED
        assert fly(None, ideal=True).header.backend == name_backend(Backend.INTERPRETED)
        with pytest.raises(NoMachineCodeError, match="expected a working C compiler, no-such-compiler or"):
            fly(Backend.COMPILED, ideal=True)
    finally:
        best_backend.cache_clear()
        prepare_function.cache_clear()


@needs_compiler
def test_machine_code_of_other_bits_is_not_used(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Negative control: one changed bit of a constant is refused."""
    x = ca.SX.sym("x", 3)
    function = ca.Function("linear", [x], [0.1 * x[0] + 0.2 * x[1] * x[2]])
    assert same_bits(function, prepare_function(function, Backend.COMPILED))
    off = ca.Function("linear", [x], [np.nextafter(0.1, 1.0) * x[0] + 0.2 * x[1] * x[2]])
    assert not same_bits(function, off)
    monkeypatch.setattr(backends, "same_bits", lambda *_: False)
    with pytest.raises(
        BitMismatchError, match="machine code of 'other' with the interpreter's bits, got other"
    ):
        prepare_function(ca.Function("other", [x], [x[0] * x[1]]), Backend.COMPILED)


@needs_compiler
def test_machine_code_is_compiled_once_and_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    source = tmp_path / "seven.c"
    source.write_text("int seven(void) { return 7; }\n")
    made = shared_library([source])
    time = made.stat().st_mtime_ns
    assert shared_library([source]) == made
    assert made.stat().st_mtime_ns == time
    source.write_text("int seven(void) { return 8; }\n")
    assert shared_library([source]) != made
    source.write_text("this is no C\n")
    with pytest.raises(NoMachineCodeError, match="error"):
        shared_library([source])
    assert len(list((tmp_path / "cache").rglob("*.so"))) == 2


def test_a_cache_that_cannot_be_written_is_no_traceback(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    source = tmp_path / "seven.c"
    source.write_text("int seven(void) { return 7; }\n")
    with pytest.raises(NoMachineCodeError, match="expected a working C compiler"):
        shared_library([source])
