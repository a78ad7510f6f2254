"""Tables kept in the user's cache folder.

A file holds a line of JSON, padded, and the values. It is mapped read-only and checked when opened; one that
is torn is made anew. A lock for each key keeps two processes from making the same table.
"""

import fcntl
import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path

import numpy as np

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from runtime.atomic_write import write_atomically
from runtime.compiler import cache_folder

from .build import solver_digest
from .problem import ShortestPathProblem, state_problem
from .solve import solve
from .table import CostTable

MOST_BYTES = 2_000_000_000
"""Bytes that all tables may take together; the ones unused for longest go."""

_HEADER = 4096
_ENDING = ".costs"


def find_table(
    library: Library,
    *,
    tolerance: float,
    goal_trim: int | None = None,
    error_scale: float = 1.0,
    threads: int = 2,
) -> CostTable:
    """Returns the table of a library and goal, cached or made.

    Args:
        library: the primitives.
        tolerance: radius around the goal in metres.
        goal_trim: id of the trim wanted at the goal; None leaves it free.
        error_scale: factor of all standard deviations.
        threads: that make a missing table.

    Raises:
        FlightError: the problem cannot be stated or solved, or there is no C compiler.
    """
    problem = state_problem(library, tolerance=tolerance, goal_trim=goal_trim, error_scale=error_scale)
    settings = [library_hash(library), tolerance, goal_trim, error_scale, solver_digest(), sys.byteorder]
    key = sha256(json.dumps(settings).encode()).hexdigest()[:32]
    path = cache_folder() / "costs" / f"{key}{_ENDING}"
    found = _opened(path, problem)
    if found is None:
        path.parent.mkdir(parents=True, exist_ok=True)
        with _locked(path.with_suffix(".lock")):
            found = _opened(path, problem) or _made(path, problem, threads)
    return found


def _made(path: Path, problem: ShortestPathProblem, threads: int) -> CostTable:
    solution = solve(problem, threads=threads)
    table = CostTable(problem, solution.values, solution.gap)
    header = json.dumps({"shape": solution.values.shape, "gap": solution.gap, "sha256": table.digest})
    _make_room(path.parent, _HEADER + solution.values.nbytes)
    write_atomically(header.encode().ljust(_HEADER) + solution.values.tobytes(), path, force=True)
    return _opened(path, problem) or table


def _opened(path: Path, problem: ShortestPathProblem) -> CostTable | None:
    """Returns the table in a file; None if missing or torn."""
    try:
        with path.open("rb") as file:
            header = json.loads(file.read(_HEADER))
        shape = tuple(header["shape"])
        values = np.memmap(path, dtype=np.float32, mode="r", offset=_HEADER, shape=shape)
        table = CostTable(problem, values, float(header["gap"]))
        expected = (len(problem.trims), problem.grid.levels, problem.grid.side, problem.grid.side)
        if shape != expected or table.digest != header["sha256"]:
            return None
        os.utime(path)
    except (OSError, ValueError, KeyError, TypeError):
        return None
    return table


def _make_room(folder: Path, wanted: int) -> None:
    """Removes the tables unused for longest until another fits."""
    files = sorted(folder.glob(f"*{_ENDING}"), key=lambda path: path.stat().st_mtime)
    size = sum(path.stat().st_size for path in files)
    while files and size + wanted > MOST_BYTES:
        oldest = files.pop(0)
        size -= oldest.stat().st_size
        oldest.unlink(missing_ok=True)
        oldest.with_suffix(".lock").unlink(missing_ok=True)


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    """Holds a lock of this machine; it ends with the process."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
