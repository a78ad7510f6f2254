"""C sources made into machine code: by the machine's own compiler, when first needed, then kept."""

import os
import platform
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from hashlib import sha256
from pathlib import Path

from flight.errors import FlightError

COMPILERS = ("cc", "gcc", "clang")
# Numbers as written: no reordering, and no fused multiply-adds, so that every machine gives the same bits.
IEEE_FLAGS = ("-ffp-contract=off", "-fPIC", "-shared")
# A compiler that needs longer than this has failed, s.
_PATIENCE = 120


class NoMachineCodeError(FlightError):
    """A C source cannot be made into machine code here."""

    def __init__(self, why: str) -> None:
        super().__init__(f"expected a C compiler that works, one of {', '.join(COMPILERS)}: {why}")


def cache_folder() -> Path:
    """Returns where machine code is kept: under XDG_CACHE_HOME, or .cache in the home folder."""
    root = os.environ.get("XDG_CACHE_HOME")
    return (Path(root) if root else Path("~/.cache").expanduser()) / "maneuver-automaton"


def shared_library(
    sources: Sequence[Path], *, headers: Sequence[Path] = (), flags: Sequence[str] = ("-O2", *IEEE_FLAGS)
) -> Path:
    """Returns the shared library of C sources, compiled now unless it was before.

    Args:
        sources: files; the library is named for the last one.
        headers: what they include.
        flags: of the compiler.

    Raises:
        NoMachineCodeError: there is no compiler, it failed, or there is nowhere to write.
    """
    path = cache_folder() / f"{sources[-1].stem}-{_fingerprint([*sources, *headers], flags)}.so"
    try:
        if not path.is_file():
            _compile(sources, path, flags)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoMachineCodeError(str(error)) from None
    return path


def _compile(sources: Sequence[Path], path: Path, flags: Sequence[str]) -> None:
    """Compiles sources into a file, whole or not at all."""
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        raise NoMachineCodeError("there is none")
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        made = Path(folder) / path.name
        command = [compiler, *flags, *map(str, sources), "-o", str(made), "-lm"]
        done = subprocess.run(command, check=False, capture_output=True, timeout=_PATIENCE)
        if done.returncode:
            said = done.stderr.decode(errors="replace").strip().splitlines()
            raise NoMachineCodeError(said[-1] if said else f"{compiler} failed")
        made.replace(path)


def _fingerprint(files: Sequence[Path], flags: Sequence[str]) -> str:
    text = b"".join(file.read_bytes() for file in files)
    machine = (tuple(flags), platform.machine(), platform.system())
    return sha256(text + repr(machine).encode()).hexdigest()[:16]
