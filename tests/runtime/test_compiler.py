"""Compiler of the machine or of a wheel; one error line without both."""

import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from maneuver.app import run
from planner.kernel.build import load_kernel
from runtime import compiler
from runtime.compiler import NoMachineCodeError, compiler_command

PLAN = ("-m", "maneuver", "plan", "kinematic-2", "--library", "thesis-kinematic", "--gamma", "0.5", "--json")


def test_the_compiler_of_the_machine_comes_before_that_of_the_wheel(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(compiler, "WHEEL", "json")  # any package that is there
    monkeypatch.setenv("PATH", str(tmp_path))
    assert compiler_command() == (sys.executable, *compiler.WHEEL_COMMAND)
    own = tmp_path / "gcc"
    own.write_text("#!/bin/sh\n")
    own.chmod(0o755)
    assert compiler_command() == (str(own),)


def test_a_machine_without_any_compiler_plans_nothing_and_names_the_extra(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(compiler, "WHEEL", "no_such_wheel")
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    with pytest.raises(NoMachineCodeError, match="got none"):
        compiler_command()
    load_kernel.cache_clear()
    try:
        for words in (
            ["plan", "gtmax-1"],
            ["fly", "--mission", "gtmax-1", "--out", str(tmp_path / "a.mcap")],
        ):
            assert run(words) == 2
            (line,) = capsys.readouterr().err.splitlines()
            assert "expected a working C compiler, cc, gcc, clang or that of the extra `compiler`" in line
    finally:
        load_kernel.cache_clear()
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(find_spec("ziglang") is None, reason="the extra `compiler` is not installed")
def test_the_compiler_of_the_wheel_gives_the_plans_of_the_machines_own(tmp_path: Path) -> None:
    plans = []
    for name, path in (("own", os.environ["PATH"]), ("wheel", str(tmp_path))):
        place = os.environ | {"PATH": path, "XDG_CACHE_HOME": str(tmp_path / name)}
        done = subprocess.run([sys.executable, *PLAN], env=place, check=True, capture_output=True, text=True)
        plans.append([line for line in done.stdout.splitlines() if "solve_time" not in line])
    assert plans[0] == plans[1]
