"""Mutated logs, libraries, missions, plans, sequences, campaigns and vehicles, handed to the command line.

A mutation is wrong where the program ends in a traceback, takes longer than five seconds or much memory, says
more than one line, or takes a damaged log for a whole one.
"""

import contextlib
import io
import resource
import signal
import sys
import traceback
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from random import Random
from types import FrameType

import libraries
import models
from flight.errors import FlightError
from flight.mission.campaign import read_campaign
from flight.mission.sequence import read_sequence
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.viewers.mjcf_check import parse_model
from maneuver.app import BAD_INPUT, run
from scenarios.find import CAMPAIGNS, MISSIONS, SEQUENCES
from sim.vehicle.parameters import read_parameters

from .mutations import changed_bytes, changed_json, changed_log, changed_toml, changed_xml
from .study import Study

LONGEST = 5
"""Seconds of computing: the machine may be busy with something else."""

MOST_MEMORY = 1 << 30
"""Bytes that the process may grow by."""

Change = Callable[[bytes, Random], bytes]


class _TooLongError(BaseException):
    """Error that a program's own handlers cannot catch."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of file: where a good one is, the command that reads one, and how its structure is changed.

    Attributes:
        name: of the kind.
        content: of a good file.
        suffix: of its name.
        use: hands one to the program and returns its exit code.
        change: that keeps to the format.
        checked: whether the format carries checksums: a change of bytes must then be noticed.
    """

    name: str
    content: bytes
    suffix: str
    use: Callable[[Path], int]
    change: Change
    checked: bool = False


def kinds_of_files(folder: Path) -> tuple[Kind, ...]:
    """Returns every kind of file that a user may hand over, with a good one of each, made in a folder."""
    plan, log = folder / "plan.json", folder / "log.mcap"
    with _silence():
        assert run(["plan", "gtmax-1", "--library", "gtmax-sim", "--out", str(plan)]) == 0
        assert run(["fly", "--sequence", "slow-walk", "--out", str(log)]) == 0
    flown = read_log(log)
    whole = log_bytes(flown)
    library = (libraries.FOLDER / "thesis-gtmax.json").read_bytes()
    mission = (MISSIONS / "gtmax-1.toml").read_bytes()
    sequence = (SEQUENCES / "slow-walk.toml").read_bytes()
    campaign = (CAMPAIGNS / "gtmax.toml").read_bytes()
    vehicle, model = ((models.FOLDER / f"gtmax.{ending}").read_bytes() for ending in ("toml", "xml"))
    return (
        Kind("library", library, ".json", _command("library", "check"), changed_json),
        Kind("mission", mission, ".toml", _command("plan", "--library", "thesis-gtmax"), changed_toml),
        Kind("plan", plan.read_bytes(), ".json", _command("plan", "check"), changed_json),
        Kind("sequence", sequence, ".toml", _reading(read_sequence), changed_toml),
        Kind("vehicle", vehicle, ".toml", _reading(read_parameters), changed_toml),
        Kind("model", model, ".xml", _reading(_shape), changed_xml),
        Kind("campaign", campaign, ".toml", _reading(read_campaign), changed_toml),
        Kind(
            "log",
            whole,
            ".mcap",
            _reviewed,
            lambda _, chance: changed_log(flown, chance),
            True,
        ),
        Kind("torn log", whole, ".mcap", _command("recover", "--force"), changed_bytes),
    )


def _command(*words: str) -> Callable[[Path], int]:
    return lambda path: run([*words, str(path)])


def _reviewed(path: Path) -> int:
    return run(["review", str(path), "--html", "--out", str(path.parent / "review"), "--force"])


def _shape(path: Path) -> object:
    return parse_model(path.read_bytes(), path.name)


def _reading(read: Callable[[Path], object]) -> Callable[[Path], int]:
    """Returns what only reads a file: the command would fly what it says, for minutes."""

    def use(path: Path) -> int:
        try:
            read(path)
        except FlightError as error:
            print(f"maneuver: {error}", file=sys.stderr)
            return BAD_INPUT
        return 0

    return use


def outcome(kind: Kind, chance: Random, folder: Path) -> str:
    """Mutates a file, uses it, and returns what came of that; `wrong: ...` where it must not be."""
    keeps_format = chance.random() < 0.5
    content = kind.change(kind.content, chance) if keeps_format else changed_bytes(kind.content, chance)
    path = folder / f"hostile{kind.suffix}"
    path.write_bytes(content)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    errors = io.StringIO()
    try:
        with _silence(errors), _limited():
            code = kind.use(path)
    except _TooLongError:
        return f"wrong: longer than {LONGEST} s"
    except BaseException as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        return f"wrong: {type(error).__name__} in {Path(place.filename).name}:{place.lineno}"
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024
    must_fail = kind.checked and not keeps_format and content != kind.content
    return _judged(code, errors.getvalue(), grown=grown, must_fail=must_fail)


def _judged(code: int, said: str, *, grown: int, must_fail: bool) -> str:
    lines = said.strip().splitlines()
    if grown > MOST_MEMORY:
        return f"wrong: grew by {grown} bytes"
    if code not in {0, 1, 2, 3}:
        return f"wrong: exit code {code}"
    if code == BAD_INPUT and (len(lines) != 1 or not lines[0].startswith("maneuver: ")):
        return f"wrong: exit code {code} with {len(lines)} lines"
    if must_fail and code != BAD_INPUT:
        return "wrong: damage not noticed"
    return f"exit code {code}"


@contextlib.contextmanager
def _silence(errors: io.StringIO | None = None) -> Iterator[None]:
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(errors or io.StringIO()):
        yield


@contextlib.contextmanager
def _limited() -> Iterator[None]:
    def stop(number: int, frame: FrameType | None) -> None:
        raise _TooLongError

    previous = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, previous)


def count_wrong(kinds: Iterable[Kind], study: Study, folder: Path) -> int:
    """Returns the wrong outcomes of a study of mutations, and prints all outcomes."""
    mutations, seed = study.size("mutations", 1000), study.size("seed", 1)
    outcomes = Counter[tuple[str, str]]()
    for number, kind in zip(range(mutations), cycle(kinds), strict=False):
        result = outcome(kind, Random(f"{seed} {number}"), folder)
        outcomes[kind.name, result] += 1
        if result.startswith("wrong"):
            study.show(f"mutation {number} of seed {seed}: {kind.name}: {result}")
    for (name, result), count in sorted(outcomes.items()):
        study.show(f"{name:13s} {count:6d}  {result}")
    wrong = sum(count for (_, result), count in outcomes.items() if result.startswith("wrong"))
    study.show_share(wrong, mutations, "mutations")
    return wrong
