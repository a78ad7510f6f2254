"""Compilation of C sources by the machine's compiler, cached."""

import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from flight.errors import FlightError

COMPILERS = ("cc", "gcc", "clang")
WHEEL = "ziglang"
"""Module that the extra `compiler` installs; it is used where the machine has no compiler of its own."""

# Zig would use all that this very processor can do; the cache may be shared with others of its kind.
WHEEL_COMMAND = ("-m", WHEEL, "cc", "-mcpu=baseline")
# Numbers as written: no reordering, and no fused multiply-adds, so that every machine gives the same bits.
IEEE_FLAGS = ("-ffp-contract=off", "-fPIC", "-shared")
# Seconds after which a compilation counts as failed.
_COMPILER_TIMEOUT = 120


class NoMachineCodeError(FlightError):
    """Failure to compile a C source on this machine."""

    def __init__(self, why: str) -> None:
        super().__init__(
            f"expected a working C compiler, {', '.join(COMPILERS)} or that of the extra `compiler` "
            f"(pip install '.[compiler]'): {why}"
        )


def cache_folder() -> Path:
    """Returns the machine-code cache: XDG_CACHE_HOME or .cache at home."""
    root = os.environ.get("XDG_CACHE_HOME")
    return (Path(root) if root else Path("~/.cache").expanduser()) / "maneuver-automaton"


def shared_library(
    sources: Sequence[Path], *, headers: Sequence[Path] = (), flags: Sequence[str] = ("-O2", *IEEE_FLAGS)
) -> Path:
    """Returns the shared library of C sources, compiled if needed.

    Args:
        sources: source files; the library is named for the last one.
        headers: header files.
        flags: compiler flags.

    Raises:
        NoMachineCodeError: there is no compiler, it failed, or the cache cannot be written.
    """
    path = cache_folder() / f"{sources[-1].stem}-{_fingerprint([*sources, *headers], flags)}.so"
    try:
        if not path.is_file():
            _compile(sources, path, flags)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoMachineCodeError(str(error)) from None
    return path


def compiler_command() -> tuple[str, ...]:
    """Returns the command that compiles C here.

    Raises:
        NoMachineCodeError: there is none.
    """
    found = next(filter(None, map(shutil.which, COMPILERS)), None)
    if found is not None:
        return (found,)
    if find_spec(WHEEL) is not None:
        return (sys.executable, *WHEEL_COMMAND)
    raise NoMachineCodeError("got none")


def _compile(sources: Sequence[Path], path: Path, flags: Sequence[str]) -> None:
    """Compiles sources into a file atomically."""
    compiler = compiler_command()
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        made = Path(folder) / path.name
        command = [*compiler, *flags, *map(str, sources), "-o", str(made), "-lm"]
        done = subprocess.run(command, check=False, capture_output=True, timeout=_COMPILER_TIMEOUT)
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines()
            raise NoMachineCodeError(said[-1] if said else f"{' '.join(compiler)} failed")
        made.replace(path)


def _fingerprint(files: Sequence[Path], flags: Sequence[str]) -> str:
    text = b"".join(file.read_bytes() for file in files)
    machine = (tuple(flags), platform.machine(), platform.system())
    return sha256(text + repr(machine).encode()).hexdigest()[:16]
