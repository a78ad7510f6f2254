"""One campaign in many ways: the logs and the library must be the same to the last bit in all of them.

With 1, 2 and 8 workers; in another order; stopped half-way and resumed; with more threads for linear
algebra; and on a cluster with a scheduler and two worker processes, where `distributed` is installed. Then
every log is flown again from itself. One hash stands for the files of a way: names, logs, library, data
sheet.
"""

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from random import Random
from typing import Any

from experiments.campaign.fly_campaign import CampaignOrder, fly_campaign
from runtime.executor import JobExecutor
from scenarios.find import find_campaign
from tests.support.small_campaign import write_small_campaign

from .local_cluster import local_cluster

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


class Ways:
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


def hash_of(folder: Path) -> str:
    """Returns one hash for all files below a folder, with their names."""
    digest = sha256()
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        digest.update(str(path.relative_to(folder)).encode() + b"\0" + sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def hashes(folder: Path, *, flights: int, workers: tuple[int, ...]) -> Iterator[tuple[str, str]]:
    """Yields each way with its hash."""
    ways = Ways(folder, flights=flights)
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
        with local_cluster(folder) as (file, _):
            for name, more in (("cluster, by value", []), ("cluster, shared folder", ["--shared-folder"])):
                yield name, ways.by_command(name, "--cluster", str(file), *more)
