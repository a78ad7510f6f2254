"""RotorPy from the package index, in a cached environment of its own."""

import subprocess
import sys
import venv
from pathlib import Path

from flight.errors import FlightError
from runtime.compiler import cache_folder

PEER = "rotorpy>=3,<4"
_LOOP = Path(__file__).parent / "rotorpy_loop.py"
# The package brings Matplotlib and others with it.
_PATIENCE = 900


class NoPeerError(FlightError):
    """RotorPy is not available on this machine."""

    def __init__(self, why: str) -> None:
        super().__init__(f"RotorPy is not available, no comparison: {why}")


def peer_speed() -> float:
    """Returns simulated seconds per CPU second of RotorPy's own loop.

    Raises:
        NoPeerError: it cannot be installed or does not run.
    """
    try:
        return float(_run(_python(), str(_LOOP)).split()[-1])
    except (OSError, subprocess.TimeoutExpired, ValueError) as error:
        raise NoPeerError(str(error)) from None


def _python() -> Path:
    """Returns the Python of an environment that has RotorPy."""
    folder = cache_folder() / f"rotorpy-3-python-{sys.version_info.major}.{sys.version_info.minor}"
    python = folder / "bin" / "python"
    if not (folder / "installed").exists():
        print(f"making an environment for {PEER} in {folder}", file=sys.stderr)
        venv.create(folder, clear=True, with_pip=True)
        _run(python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", PEER)
        (folder / "installed").touch()
    return python


def _run(python: Path, *arguments: str) -> str:
    """Returns the output of a program."""
    done = subprocess.run(
        [python, *arguments], capture_output=True, text=True, timeout=_PATIENCE, check=False
    )
    if done.returncode:
        lines = done.stderr.strip().splitlines()
        raise NoPeerError(lines[-1] if lines else f"{' '.join(arguments)} failed")
    return done.stdout
