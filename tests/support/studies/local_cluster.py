"""A cluster of this machine: a scheduler and two workers, each a process."""

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

Cluster = tuple[Path, list[subprocess.Popen[bytes]]]
"""The scheduler's file, and the processes: the scheduler, then the workers."""


@contextmanager
def local_cluster(folder: Path) -> Iterator[Cluster]:
    """Lends a scheduler and two workers, whose files stand in a folder."""
    file = folder / "scheduler.json"
    scheduler = ["scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)]
    worker = ["worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny"]
    with ExitStack() as stack:

        def start(words: list[str]) -> subprocess.Popen[bytes]:
            command = [sys.executable, "-m", "dask", *words, "--no-dashboard"]
            quiet = subprocess.DEVNULL
            process = stack.enter_context(subprocess.Popen(command, cwd=folder, stdout=quiet, stderr=quiet))
            stack.callback(process.kill)
            return process

        processes = [start(words) for words in (scheduler, worker, worker)]
        while not file.exists():
            time.sleep(0.1)
        yield file, processes
