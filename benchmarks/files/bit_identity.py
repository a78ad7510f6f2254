"""One campaign in many ways: the logs and the library must be the same to the last bit in all of them.

With 1, 2 and 8 workers; in another order; stopped half-way and resumed; with more threads for linear
algebra; and on a cluster with a scheduler and two worker processes, where `distributed` is installed. Then
every log is flown again from itself. One hash stands for the files of a way: names, logs, library, data
sheet.

For example:

    python -m benchmarks.files.bit_identity --flights 16
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from random import Random
from typing import Any

from benchmarks.upper_limit import upper_limit
from experiments.campaign.fly_campaign import CampaignOrder, fly_campaign
from runtime.executor import JobExecutor
from scenarios.find import find_campaign
from tests.support.small_campaign import write_small_campaign

SEED = 5


class _Shuffled(Executor):
    """Runs work in another order than it was handed in."""

    def __init__(self, pool: Executor, chance: Random, *, batch: int) -> None:
        self._pool, self._chance, self._batch = pool, chance, batch
        self._waiting: list[tuple[Future[Any], Any]] = []

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Waits for a batch, and runs it shuffled."""
        future: Future[Any] = Future()
        self._waiting.append((future, lambda: fn(*args, **kwargs)))
        if len(self._waiting) == self._batch:
            self._chance.shuffle(self._waiting)
            for waiting, work in self._waiting:
                self._pool.submit(work).add_done_callback(_hand_to(waiting))
        return future


def _hand_to(waiting: Future[Any]) -> Any:
    return lambda done: waiting.set_result(done.result())


class LibraryRuns:
    """The ways to make one library.

    Args:
        folder: for everything.
        flights: of the campaign.
    """

    def __init__(self, folder: Path, *, flights: int) -> None:
        self._folder, self._flights = folder, flights
        self._campaign = write_small_campaign(folder, flights=flights)

    def by_command(self, name: str, *words: str, environment: Mapping[str, str] | None = None) -> str:
        """Regenerates with a command, and returns the hash of all its files."""
        out = self._folder / name
        command = [sys.executable, "-m", "maneuver", "regenerate", "--campaign", str(self._campaign)]
        command += [
            "--seed",
            str(SEED),
            "--logs",
            str(out / "logs"),
            "--out",
            str(out / "small.json"),
            "--json",
        ]
        done = subprocess.run(
            [*command, *words], check=False, capture_output=True, env={**os.environ, **(environment or {})}
        )
        assert done.returncode == 0, done.stderr.decode()
        return hash_of(out)

    def shuffled(self) -> str:
        """Flies in another order, then regenerates from the logs that are there."""
        name = "shuffled"
        with ThreadPoolExecutor(1) as pool:
            shuffled = _Shuffled(pool, Random(1), batch=self._flights)
            fly_campaign(
                self._order(), self._folder / name / "logs", job_executor=JobExecutor(shuffled, by_value=True)
            )
        return self.by_command(name, "--workers", "1")

    def resumed(self) -> str:
        """Flies every other flight beforehand."""
        folder = self._folder / "resumed" / "logs"
        folder.mkdir(parents=True)
        for flight in self._order().jobs(folder)[::2]:
            for path, content in flight.run().files:
                path.write_bytes(content)
        return self.by_command("resumed", "--workers", "2")

    def replayed(self) -> tuple[int, int]:
        """Flies every log again, and returns how many differ, and how many there are."""
        logs = sorted((self._folder / "1 worker" / "logs").iterdir())
        command = [sys.executable, "-m", "maneuver", "replay", *map(str, logs)]
        said = subprocess.run(command, check=False, capture_output=True, text=True).stdout.splitlines()
        same = sum(": 0 of " in line for line in said)
        return len(logs) - same, len(logs)

    def _order(self) -> CampaignOrder:
        campaign = find_campaign(str(self._campaign))
        return CampaignOrder(campaign, seed=SEED, flights=self._flights, wind=campaign.wind)


@contextmanager
def cluster(folder: Path) -> Iterator[Path]:
    """Lends a scheduler and two workers on this machine, by the scheduler's file."""
    file = folder / "scheduler.json"
    scheduler = ["scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)]
    worker = ["worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny"]
    with ExitStack() as stack:
        for words in (scheduler, worker, worker):
            command = [sys.executable, "-m", "dask", *words, "--no-dashboard"]
            quiet = subprocess.DEVNULL
            process = stack.enter_context(subprocess.Popen(command, cwd=folder, stdout=quiet, stderr=quiet))
            stack.callback(process.kill)
        while not file.exists():
            time.sleep(0.1)
        yield file


def hash_of(folder: Path) -> str:
    """Returns one hash for all files below a folder, with their names."""
    digest = sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        digest.update(str(path.relative_to(folder)).encode() + b"\0" + sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def hashes(folder: Path, *, flights: int, workers: tuple[int, ...]) -> Iterator[tuple[str, str]]:
    """Yields each way with its hash."""
    ways = LibraryRuns(folder, flights=flights)
    for count in workers:
        name = f"{count} worker{'s' * (count > 1)}"
        yield name, ways.by_command(name, "--workers", str(count))
    yield "shuffled", ways.shuffled()
    yield "stopped and resumed", ways.resumed()
    for threads in ("1", "4"):
        name = f"{threads} BLAS threads"
        variables = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
        yield name, ways.by_command(name, "--workers", "1", environment=dict.fromkeys(variables, threads))
    if find_spec("distributed"):
        with cluster(folder) as file:
            for name, more in (("cluster, by value", []), ("cluster, shared folder", ["--shared-folder"])):
                yield name, ways.by_command(name, "--cluster", str(file), *more)


def main() -> None:
    """Prints the hash of every way, how many there are, and what replays differ in."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--flights", type=int, default=16)
    parser.add_argument("--workers", type=int, nargs="*", default=[1, 2, 8])
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        found = []
        for way, digest in hashes(Path(name), flights=arguments.flights, workers=tuple(arguments.workers)):
            print(f"{digest}  {way}", flush=True)
            found.append(digest)
        print(
            f"{len(set(found))} hash of {arguments.flights} logs, library and data sheet in {len(found)} ways"
        )
        ways = LibraryRuns(Path(name), flights=arguments.flights)
        differ, logs = ways.replayed()
    limit = 100 * upper_limit(differ, logs)
    print(f"{differ} of {logs} logs differ when flown again from themselves; 95 % upper limit {limit:.1f} %")


if __name__ == "__main__":
    main()
