"""The kernel's machine code: compiled by the machine's own C compiler when first needed, then kept.

Where there is no compiler, or it fails, there is no kernel, and the planner searches with NumPy and CasADi.
"""

import ctypes
import os
import platform
import shutil
import subprocess
import tempfile
from functools import cache
from hashlib import sha256
from pathlib import Path

SOURCES = ("times.c", "curves.c", "search.c")
"""Each includes the one before it."""

COMPILERS = ("cc", "gcc", "clang")

# No fused multiply-adds: the same source gives the same plans on every machine of a kind.
FLAGS = (
    "-O2",
    "-std=gnu11",
    "-fcx-limited-range",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fPIC",
    "-shared",
)


@cache
def kernel() -> ctypes.CDLL | None:
    """Returns the compiled kernel, or None where it cannot be had."""
    path = cache_folder() / f"kernel-{_fingerprint()}.so"
    try:
        if not path.is_file():
            compile_to(path)
        return ctypes.CDLL(str(path))
    except (OSError, subprocess.SubprocessError):
        return None


def cache_folder() -> Path:
    """Returns where machine code is kept: under XDG_CACHE_HOME, or .cache in the home folder."""
    root = os.environ.get("XDG_CACHE_HOME")
    return (Path(root) if root else Path("~/.cache").expanduser()) / "maneuver-automaton"


def compile_to(path: Path) -> None:
    """Compiles the kernel into a file, whole or not at all.

    Raises:
        OSError: there is no compiler, or nowhere to write.
        SubprocessError: the compiler failed.
    """
    compiler = next(filter(None, map(shutil.which, COMPILERS)), None)
    if compiler is None:
        raise FileNotFoundError(f"expected a C compiler, one of {', '.join(COMPILERS)}")
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=path.parent) as folder:
        made = Path(folder) / path.name
        source = Path(__file__).parent / SOURCES[-1]
        command = [compiler, *FLAGS, str(source), "-o", str(made), "-lm"]
        subprocess.run(command, check=True, capture_output=True, timeout=60)
        made.replace(path)


def _fingerprint() -> str:
    folder = Path(__file__).parent
    text = b"".join((folder / name).read_bytes() for name in SOURCES)
    return sha256(text + repr((FLAGS, platform.machine(), platform.system())).encode()).hexdigest()[:16]
