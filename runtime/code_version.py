"""Version of the flying code, stored in every log."""

from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from .version import VERSION

FOLDERS = ("experiments", "flight", "flightlog", "identification", "models", "planner", "runtime", "sim")
"""Packages that determine a flight and the evaluation of its log."""

_ENDINGS = {".py", ".c", ".toml", ".xml"}
# Numeric packages; CasADi is in the log's back-end.
_ARITHMETIC = ("mujoco", "numpy", "scipy")
_DIGITS = 12


@cache
def code_version() -> str:
    """Returns the program's version and a digest of code and numerics."""
    digest = sha256()
    root = Path(__file__).parents[1]
    for path in sorted(path for folder in FOLDERS for path in (root / folder).rglob("*")):
        if path.suffix in _ENDINGS:
            digest.update(path.relative_to(root).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    for name in _ARITHMETIC:
        digest.update(f"{name} {version(name)}\n".encode())
    return f"{VERSION}+{digest.hexdigest()[:_DIGITS]}"
