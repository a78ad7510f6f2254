"""Process pool with one linear-algebra thread for each process."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from .atomic_write import write_atomically


def overwrite_atomically(content: bytes, path: Path) -> None:
    """Writes a file atomically over any existing one."""
    write_atomically(content, path, force=True)


@dataclass(frozen=True, slots=True)
class JobExecutor:
    """Executor of jobs, with the way that their files return.

    Attributes:
        executor: runs the jobs.
        by_value: True if workers send files back; otherwise they write them into a shared folder.
        write: writes a file that was sent back.
    """

    executor: Executor
    by_value: bool = False
    write: Callable[[bytes, Path], None] = overwrite_atomically


# Thread counts of every BLAS that NumPy may have been built with: more than one changes bits and wastes
# cores.
_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


@contextmanager
def worker_pool(processes: int) -> Iterator[Executor]:
    """Yields a pool of fresh processes with single-threaded linear algebra."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    try:
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(processes, mp_context=context, initializer=_set_up_worker) as pool:
            try:
                yield pool
            except BaseException:
                pool.shutdown(cancel_futures=True)
                raise
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


def _set_up_worker() -> None:
    """Ignores signals in a worker and ends it with its parent.

    After a stop signal workers finish the flight in progress.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None, "a worker has a parent process"
    parent.join()
    os._exit(1)


def default_workers() -> int:
    """Returns the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
