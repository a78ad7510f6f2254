"""Digests of the code that computes and that evaluates flights.

A log carries the first, stored results of evaluated flights carry both. The command line, pages and pictures
are part of neither.
"""

from collections.abc import Iterable
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from .version import VERSION

FLIGHT_CODE = (
    *("flight", "flightlog", "models", "sim", "runtime/compiler.py"),
    *(f"planner/{room}" for room in ("check", "closed_loop", "commitment", "kernel")),
    *(f"planner/{room}" for room in ("policies", "recourse", "walks")),
    *(
        "experiments/mission/feedback.py",
        "experiments/mission/flight_rule.py",
        "experiments/mission/fly.py",
        "experiments/mission/mission_log.py",
        "experiments/mission/mission_task.py",
    ),
    "experiments/mission/timed_planner.py",
)
"""Folders and files that determine a flight and its log."""

EVALUATION_CODE = ("experiments/mission", "identification")
"""Folders that determine segments and results of a flight."""

EXCLUDED = ("flightlog/imports", "sim/checks")
"""Folders among them that no flight uses."""

_ROOT = Path(__file__).parents[1]
_ENDINGS = {".py", ".c", ".h", ".toml", ".xml"}
# Numeric packages; CasADi is in the log's back-end.
_ARITHMETIC = ("mujoco", "numpy", "scipy")
_DIGITS = 12


@cache
def code_version() -> str:
    """Returns version and digest of the code that computes flights."""
    return f"{VERSION}+{digest(FLIGHT_CODE)}"


@cache
def evaluation_version() -> str:
    """Returns the digest of the code that evaluates flights."""
    return digest(EVALUATION_CODE)


def digest(places: Iterable[str], root: Path = _ROOT) -> str:
    """Returns a digest of sources and of the numeric packages.

    Args:
        places: folders and files.
        root: folder that they are in.
    """
    found = sha256()
    excluded = [root / one for one in EXCLUDED]
    for path in sorted({path for place in places for path in (root / place, *(root / place).rglob("*"))}):
        if path.suffix in _ENDINGS and not any(path.is_relative_to(one) for one in excluded):
            found.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    for name in _ARITHMETIC:
        found.update(f"{name} {version(name)}\n".encode())
    return found.hexdigest()[:_DIGITS]
