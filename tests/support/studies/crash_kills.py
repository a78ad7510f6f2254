"""Campaigns killed at random: `maneuver regenerate`, its process group killed again and again (SIGKILL).

After each kill every visible file must be whole, and what was there must still be; in the end the library and
its data sheet must be those of the undisturbed run, with nothing left beside them.
"""

import os
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from random import Random
from time import monotonic

from tests.support.small_campaign import write_small_campaign

SEED = 1


@dataclass(slots=True)
class Killing:
    """A campaign that is killed again and again.

    Attributes:
        campaign: its file.
        workers: processes.
        chance: when to kill.
        logs: digest of each flight's log, undisturbed, by name.
        made: library and data sheet, undisturbed, by name.
        longest: seconds of the quickest run to an end; kills come before that.
        counts: kills, ends, and what was wrong.
    """

    campaign: Path
    workers: int
    chance: Random
    logs: dict[str, str] = field(default_factory=dict)
    made: dict[str, bytes] = field(default_factory=dict)
    longest: float = 0.0
    counts: Counter[str] = field(default_factory=Counter)

    def undisturbed(self, folder: Path) -> None:
        """Runs the campaign to its end, and keeps what it came to."""
        began = monotonic()
        done = self._start(folder, "--logs", str(folder / "logs")).wait()
        self.longest = monotonic() - began
        assert done == 0, f"the undisturbed run ended with {done}"
        self.logs = digests(folder / "logs")
        self.made = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}

    def until(self, kills: int, folder: Path) -> None:
        """Runs the campaign to its end, and kills it on the way until it has been killed so often in all."""
        there: set[str] = set()
        while True:
            process, began = self._start(folder), monotonic()
            patience = self.chance.uniform(0.2, 1.0) * self.longest
            try:
                code = process.wait(patience if self.counts["kills"] < kills else None)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                self.counts["kills"] += 1
                there = self._look(folder, there)
                continue
            # The machine may have become faster: then kills must come sooner.
            self.longest = min(self.longest, monotonic() - began)
            self._finish(folder, code)
            return

    def _look(self, folder: Path, before: set[str]) -> set[str]:
        found = digests(folder / "small-flights")
        if any(self.logs.get(name) != digest for name, digest in found.items()):
            self.counts["wrong: a visible log is not whole, or of no flight"] += 1
        visible = {path.name: path for path in folder.iterdir() if path.is_file() and path.name[0] != "."}
        if any(path.read_bytes() != self.made.get(name) for name, path in visible.items()):
            self.counts["wrong: a visible library or data sheet is not whole"] += 1
        # Flights go when, and only when, library and data sheet are there.
        if not before <= found.keys() and visible.keys() != self.made.keys():
            self.counts["wrong: a flight that was there is lost"] += 1
        return set(found)

    def _finish(self, folder: Path, code: int) -> None:
        self.counts["campaigns finished"] += 1
        if code != 0:
            self.counts[f"wrong: ended with {code}"] += 1
        if {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()} != self.made:
            self.counts["wrong: other bytes than undisturbed, or files beside them"] += 1
        if {path.name for path in folder.iterdir()} != self.made.keys():
            self.counts["wrong: something left"] += 1

    def _start(self, folder: Path, *more: str) -> subprocess.Popen[bytes]:
        words = ["regenerate", "--campaign", str(self.campaign), "--seed", str(SEED), "--json"]
        words += ["--workers", str(self.workers), "--out", str(folder / "small.json"), *more]
        return subprocess.Popen(
            [sys.executable, "-m", "maneuver", *words],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )


def digests(folder: Path) -> dict[str, str]:
    """Returns the SHA-256 of every visible file of a folder; empty where there is none."""
    return {path.name: sha256(path.read_bytes()).hexdigest() for path in folder.glob("[!.]*")}


def killed(kills: int, *, flights: int, workers: int, seed: int) -> Counter[str]:
    """Kills campaigns so often, and returns what was seen."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        campaign = write_small_campaign(folder, flights=flights)
        killing = Killing(campaign, workers, Random(seed))
        (folder / "undisturbed").mkdir()
        killing.undisturbed(folder / "undisturbed")
        number = 0
        while killing.counts["kills"] < kills:
            place = folder / str(number)
            place.mkdir()
            killing.until(kills, place)
            number += 1
        return killing.counts
