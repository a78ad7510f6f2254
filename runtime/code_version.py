"""Versions of the code: of what computes a flight, and of what judges it too.

A log names the first, so that a flight of other code is told from ours; what is kept of flights that were
judged names both. The command line, pages and pictures are part of neither.
"""

from collections.abc import Iterable
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from .version import VERSION

FLIES = (
    *("flight", "flightlog", "models", "sim", "runtime/compiler.py"),
    *(f"planner/{room}" for room in ("check", "closed_loop", "commitment", "kernel", "policies", "walks")),
    *(f"experiments/mission/{one}.py" for one in ("fly", "mission_log", "policies", "task", "timed_planner")),
)
"""Folders and files that decide how a flight goes, and what its log holds."""

JUDGES = ("experiments/mission", "identification")
"""Those that decide how its primitives are cut, and what it came to; scorecards are made of that anew."""

APART = ("flightlog/imports", "sim/checks")
"""Rooms of theirs that no flight passes through."""

_ROOT = Path(__file__).parents[1]
_ENDINGS = {".py", ".c", ".h", ".toml", ".xml"}
# What computes, beside CasADi, which a log names as its back-end.
_ARITHMETIC = ("mujoco", "numpy", "scipy")
_DIGITS = 12


@cache
def code_version() -> str:
    """Returns the program's version and, after a `+`, a digest of what flies: sources, models, arithmetic."""
    return f"{VERSION}+{digest(FLIES)}"


@cache
def judging_version() -> str:
    """Returns a digest of what judges flights."""
    return digest(JUDGES)


def digest(places: Iterable[str], root: Path = _ROOT) -> str:
    """Returns a digest of sources, and of the versions of what computes beside them.

    Args:
        places: folders and files.
        root: where they are.
    """
    found = sha256()
    apart = [root / one for one in APART]
    for path in sorted({path for place in places for path in (root / place, *(root / place).rglob("*"))}):
        if path.suffix in _ENDINGS and not any(path.is_relative_to(one) for one in apart):
            found.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    for name in _ARITHMETIC:
        found.update(f"{name} {version(name)}\n".encode())
    return found.hexdigest()[:_DIGITS]
