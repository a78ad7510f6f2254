"""Machine code of value iteration: compiled when first needed, then cached."""

import ctypes
from functools import cache
from hashlib import sha256
from pathlib import Path

from runtime.compiler import IEEE_FLAGS, NoMachineCodeError, shared_library

_FOLDER = Path(__file__).parent
_SOURCES = (_FOLDER / "look_up.c", _FOLDER / "sweep.c")
_HEADERS = (_FOLDER / "recourse.h",)
_FLAGS = (
    *("-O2", *IEEE_FLAGS, "-std=gnu11", "-fvisibility=hidden"),
    *("-fno-math-errno", "-fno-trapping-math"),
)


@cache
def load_recourse() -> ctypes.CDLL:
    """Returns the compiled code.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    path = shared_library(_SOURCES, headers=_HEADERS, flags=_FLAGS)
    try:
        return ctypes.CDLL(str(path))
    except OSError as error:
        raise NoMachineCodeError(str(error)) from None


@cache
def solver_digest() -> str:
    """Returns the SHA-256 of all code that a table depends on."""
    files = sorted(path for path in _FOLDER.iterdir() if path.suffix in {".c", ".h", ".py"})
    return sha256(b"".join(path.read_bytes() for path in files) + repr(_FLAGS).encode()).hexdigest()
