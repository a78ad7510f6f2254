"""Campaigns that are stopped at every step: nothing may be lost, doubled or seen in part.

A campaign is flown and identified with every step of every file noted. Then, for each step, the files are
laid out as a disk may hold them after a crash there, and the same command goes on. Wrong is: a file that is
visible and not whole; a flight that was reported and is gone; in the end, a file more, a file less, or
another byte than in the undisturbed run. A writer that opens files in their place and never syncs shows that
the harness sees such things. Flights are flown once and remembered, because it is the writing that is tested;
`crash_kills` flies them.
"""

import shutil
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Executor, Future
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from experiments.campaign.evidence import gather_evidence
from experiments.campaign.fly_campaign import CampaignOrder, fly_campaign
from flight.automaton.library_file import library_text
from flight.errors import CannotWriteError
from identification.data_sheet import data_sheet
from identification.identify import identify
from runtime.atomic_write import FileSystem, remove_partial_files, write_atomically
from runtime.executor import JobExecutor
from scenarios.find import find_campaign
from tests.support.small_campaign import write_small_campaign
from tests.support.studies.crash_disk import DiskStep, Loss, NotingDisk, after_crash

Writer = Callable[[bytes, Path, FileSystem], None]
Files = dict[str, bytes]


def whole_writer(content: bytes, path: Path, file_system: FileSystem) -> None:
    """Writes as the program does."""
    write_atomically(content, path, force=True, file_system=file_system)


def naive_writer(content: bytes, path: Path, file_system: FileSystem) -> None:
    """Writes a file in its place, and hopes."""
    descriptor = file_system.open(path)
    while content:
        content = content[file_system.write(descriptor, content) :]
    file_system.close(descriptor)


class Remembering(Executor):
    """Runs work at once, in this process, and each flight only once."""

    def __init__(self) -> None:
        self._known: dict[str, Any] = {}

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Runs the function, or answers as it did before for work of the same name."""
        future: Future[Any] = Future()
        key = f"{fn.__name__} {args[0].path.name}"
        if key not in self._known:
            self._known[key] = fn(*args, **kwargs)
        future.set_result(self._known[key])
        return future


@dataclass(slots=True)
class Sweep:
    """A campaign and what it should come to.

    Attributes:
        order: what is flown.
        place: where it is flown; emptied before every trial.
        executor: that flies.
        expected: every file of the undisturbed run, by its name below the place.
    """

    order: CampaignOrder
    place: Path
    executor: Remembering
    expected: Files

    @classmethod
    def of(cls, folder: Path, *, flights: int) -> "Sweep":
        """Flies the campaign once, undisturbed."""
        campaign = find_campaign(str(write_small_campaign(folder, flights=flights)))
        order = CampaignOrder(campaign, seed=1, flights=flights, wind=campaign.wind)
        sweep = cls(order, folder / "place", Remembering(), {})
        sweep.lay_out({})
        sweep.run(whole_writer, FileSystem())
        sweep.expected = sweep.files()
        return sweep

    def run(
        self, writer: Writer, file_system: FileSystem, *, reported: list[tuple[int, str]] | None = None
    ) -> None:
        """Flies what is missing, and identifies the library.

        Args:
            writer: of the files.
            file_system: that they are written to.
            reported: takes the number of steps after which each file was said to be there.
        """

        def write(content: bytes, path: Path) -> None:
            writer(content, path, file_system)
            if reported is not None and isinstance(file_system, NotingDisk):
                reported.append((len(file_system.steps), self._name(path)))

        job_executor = JobExecutor(self.executor, by_value=True, write=write)
        flown = fly_campaign(self.order, self.place / "flights", job_executor=job_executor)
        logs = [flight.path for flight in flown.flights]
        # What `regenerate` does before it writes a library.
        remove_partial_files(self.place, of="small*")
        library = identify(gather_evidence(logs, executor=_Inline()), name="small")
        for ending, text in ((".json", library_text(library)), (".md", data_sheet(library))):
            write(text.encode(), self.place / f"small{ending}")

    def files(self) -> Files:
        """Returns every file that there is, by its name below the place."""
        return {self._name(path): path.read_bytes() for path in self.place.rglob("*") if path.is_file()}

    def lay_out(self, files: Files) -> None:
        """Makes the place as if these files were all that there is."""
        shutil.rmtree(self.place, ignore_errors=True)
        (self.place / "flights").mkdir(parents=True)
        for name, content in files.items():
            (self.place / name).write_bytes(content)

    def faults(self, found: Files, reported: set[str]) -> set[str]:
        """Lays files out, goes on from there, and returns what is wrong; whole runs are expected after."""
        visible = {name: content for name, content in found.items() if not Path(name).name.startswith(".")}
        wrong = set()
        if any(content != self.expected.get(name) for name, content in visible.items()):
            wrong.add("partial file visible")
        if any(visible.get(name) != self.expected[name] for name in reported):
            wrong.add("reported file lost")
        self.lay_out(found)
        self.run(whole_writer, FileSystem())
        after = self.files()
        if after.keys() - self.expected.keys():
            wrong.add("file too many")
        if self.expected.keys() - after.keys():
            wrong.add("file missing")
        if any(after[name] != content for name, content in self.expected.items() if name in after):
            wrong.add("other bytes")
        return wrong

    def relative(self, found: dict[Path, bytes]) -> Files:
        """Returns files by their names below the place."""
        return {self._name(path): content for path, content in found.items()}

    def _name(self, path: Path) -> str:
        return str(path.relative_to(self.place))


class _Inline(Executor):
    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(fn(*args, **kwargs))
        return future


def note(sweep: Sweep, writer: Writer, *, piece: int) -> tuple[list[DiskStep], list[tuple[int, str]]]:
    """Returns every step of an undisturbed run, and after how many each file was said to be there."""
    file_system, reported = NotingDisk(piece), list[tuple[int, str]]()
    sweep.lay_out({})
    sweep.run(writer, file_system, reported=reported)
    return file_system.steps, reported


def crash_everywhere(sweep: Sweep, writer: Writer, *, piece: int, seed: int) -> dict[Loss, Counter[str]]:
    """Stops after every step, with every loss, and counts what is wrong after each; `points` counts all."""
    steps, reported = note(sweep, writer, piece=piece)
    counts = {loss: Counter[str]() for loss in Loss}
    for number in range(len(steps) + 1):
        for loss in Loss:
            found = sweep.relative(after_crash(steps[:number], loss, Random(f"{seed} {number} {loss}")))
            said = {name for step, name in reported if step <= number}
            wrong = sweep.faults(found, said)
            counts[loss].update(["points", *wrong, *(["caught"] if wrong else [])])
    return counts


def fill_everywhere(sweep: Sweep, *, piece: int) -> Counter[str]:
    """Lets the disk be full from every step on; the campaign must say so, and go on later."""
    steps, _ = note(sweep, whole_writer, piece=piece)
    counts = Counter[str]()
    for number in range(len(steps)):
        sweep.lay_out({})
        with suppress(CannotWriteError):
            sweep.run(whole_writer, NotingDisk(piece, full_after=number))
        found = sweep.files()
        hidden = {"half-written file left"} if any("/." in name for name in found) else set()
        wrong = hidden | sweep.faults(found, set())
        counts.update(["points", *wrong, *(["caught"] if wrong else [])])
    return counts
