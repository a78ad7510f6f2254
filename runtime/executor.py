"""Processes that share the work, each with one thread for linear algebra."""

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
    """Writes a file whole or not at all, whatever was there."""
    write_atomically(content, path, force=True)


@dataclass(frozen=True, slots=True)
class JobExecutor:
    """What does work.

    Attributes:
        executor: runs it.
        by_value: whether its workers send files back; else they write them, into a folder that is shared.
        write: writes what was sent.
    """

    executor: Executor
    by_value: bool = False
    write: Callable[[bytes, Path], None] = overwrite_atomically


# Thread counts of every BLAS that NumPy may have been built with: more than one changes bits and wastes
# cores.
_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


@contextmanager
def worker_pool(processes: int) -> Iterator[Executor]:
    """Lends a pool of fresh processes, each with one thread for linear algebra."""
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
    """Leaves signals to the process that started the work, and ends when that has ended, however it did.

    Asked to stop, workers finish the flight in hand.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    assert parent is not None, "a worker was started by somebody"
    parent.join()
    os._exit(1)


def default_workers() -> int:
    """Returns the number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
