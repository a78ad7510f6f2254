"""What the flights of a fault matrix came to, row by row, as a page and as a table to count with."""

import csv
import io
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from scipy.stats import binomtest

from experiments.mission.result import MissionResult
from flightlog.alarm import AlarmKind

from .fault_matrix import FaultCase, FaultMatrix
from .outcome import Outcome, all_faults_acted, outcome_of

CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Outcomes:
    """All flights of one fault, with protection or without.

    Attributes:
        flights: how many.
        acted: in which the fault was seen to act.
        passed: that reached their goal, and said so, inside the safe envelope, without an alarm; None outside
            the contract, where nothing passes.
        safe: that stayed inside, and were right in what they said.
        lost: that left it, and said so in time.
        wrong: that left it and did not say so, or took themselves to be at a goal where they were not.
        alarms: flights by their first alarm.
        delay: median seconds from the fault's start to the first alarm; None without one.
    """

    flights: int
    acted: int
    passed: int | None
    safe: int
    lost: int
    wrong: int
    alarms: tuple[tuple[AlarmKind, int], ...]
    delay: float | None

    @property
    def wrong_at_most(self) -> float:
        """Share of such flights that may be wrong, with 95 % confidence (Clopper, Pearson)."""
        if self.flights == 0:
            return 1.0
        test = binomtest(self.wrong, self.flights, alternative="less")
        return float(test.proportion_ci(CONFIDENCE, method="exact").high)


def count_outcomes(case: FaultCase, rows: Sequence[MissionResult]) -> Outcomes:
    """Returns what the flights of a fault came to."""
    came_to = Counter(outcome_of(row) for row in rows)
    firsts = [min(row.serious_alarms, key=lambda alarm: alarm.time) for row in rows if row.serious_alarms]
    passed = [
        row for row in rows if row.reached and outcome_of(row) is Outcome.SAFE and not row.serious_alarms
    ]
    return Outcomes(
        flights=len(rows),
        acted=sum(map(all_faults_acted, rows)),
        passed=len(passed) if case.contract else None,
        safe=came_to[Outcome.SAFE],
        lost=came_to[Outcome.DETECTED_LOSS],
        wrong=came_to[Outcome.UNDETECTED_FAILURE],
        alarms=tuple(Counter(alarm.kind for alarm in firsts).most_common()),
        delay=median(alarm.time - case.fault.start for alarm in firsts) if firsts else None,
    )


def merge_outcomes(parts: Sequence[Outcomes]) -> Outcomes:
    """Returns the outcomes of several faults as those of one."""
    alarms: Counter[AlarmKind] = Counter()
    for part in parts:
        alarms.update(dict(part.alarms))
    passed = [part.passed for part in parts if part.passed is not None]
    return Outcomes(
        flights=sum(part.flights for part in parts),
        acted=sum(part.acted for part in parts),
        passed=sum(passed) if len(passed) == len(parts) else None,
        safe=sum(part.safe for part in parts),
        lost=sum(part.lost for part in parts),
        wrong=sum(part.wrong for part in parts),
        alarms=tuple(alarms.most_common()),
        delay=None,
    )


@dataclass(frozen=True, slots=True)
class FaultReport:
    """A fault matrix, flown.

    Attributes:
        command: that makes it again.
        matrix: what was flown.
        protected: outcomes of each of its cases.
        bare: the same without protection; empty where that was not flown.
        sound: flights of the same missions in which nothing was wrong.
    """

    command: str
    matrix: FaultMatrix
    protected: tuple[Outcomes, ...]
    bare: tuple[Outcomes, ...]
    sound: Outcomes

    @property
    def acceptable(self) -> bool:
        """Whether nothing was wrong with protection, every fault acted, and what must be survived was."""
        whole = merge_outcomes(self.protected)
        return whole.wrong == 0 and whole.acted == whole.flights and self.sound.wrong == 0


NOTES = """`acted`: flights in which the log's `/fault_effect` shows the fault. `passed`, inside the contract
only: reached the goal and said so, without an alarm, inside the envelope. `safe`: inside the envelope, and
right in what the vehicle said of itself, which may be that it gives up. `lost`: left the envelope, and said
so no later than a second after. `wrong`: left it and did not say so, or took itself to be at a goal where it
was not. `wrong at most`: upper 95 % limit of the share (Clopper, Pearson). Without protection there are no
alarms, and a vehicle takes itself to be at the goal wherever its estimate is. No flight outside the contract
counts as passed, wherever it went."""

HEADS = (
    *("fault", "flights", "acted", "passed", "safe", "lost", "wrong", "wrong at most", "first alarm"),
    *("after, s", "without protection: safe", "wrong"),
)


def fault_markdown(card: FaultReport) -> str:
    """Returns the matrix as a page."""
    inside = [place for place, case in enumerate(card.matrix.cases) if case.contract]
    outside = [place for place, case in enumerate(card.matrix.cases) if not case.contract]
    envelope = card.matrix.envelope
    parts = [
        f"# Fault matrix, {card.matrix.name}",
        f"    {card.command}",
        f"Safe envelope: roll and pitch within {envelope.tilt:g} rad, height within {envelope.height:g} m, "
        f"believed position within {envelope.position:g} m and heading within {envelope.heading:g} rad of "
        "the true ones.",
        NOTES,
        "## Nothing wrong",
        _table([_row("no fault", card.sound, None)]),
        *_section("## Inside the contract: the mission goes on", card, inside),
        *_section("## Outside the contract: whoever is lost says so", card, outside),
        "## Expected",
        "\n".join(f"- `{case.fault.words}`: {case.expected}" for case in card.matrix.cases),
    ]
    return "\n\n".join(parts) + "\n"


def fault_csv(card: FaultReport) -> str:
    """Returns the matrix as CSV, a line for each fault with protection and one without."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    heads = ("flights", "acted", "passed", "safe", "lost", "wrong", "wrong_at_most", "first_alarm", "delay")
    writer.writerow(("fault", "contract", "expected", "protection", *heads))
    named = [(case.fault.words, case.contract, case.expected) for case in card.matrix.cases]
    lines = [("no fault", True, "the goal is reached", "on", card.sound)]
    lines += [(*name, "on", found) for name, found in zip(named, card.protected, strict=True)]
    lines += [(*name, "off", found) for name, found in zip(named, card.bare, strict=False)]
    for words, contract, expected, protection, found in lines:
        writer.writerow(
            (
                *(words, "inside" if contract else "outside", expected, protection),
                *(found.flights, found.acted, "" if found.passed is None else found.passed, found.safe),
                *(found.lost, found.wrong, f"{found.wrong_at_most:.4f}", _first_alarm(found)),
                "" if found.delay is None else f"{found.delay:.2f}",
            )
        )
    return stream.getvalue()


def _section(head: str, card: FaultReport, places: Sequence[int]) -> list[str]:
    return [head, _table(_rows(card, places))] if places else []


def _rows(card: FaultReport, places: Sequence[int]) -> list[list[str]]:
    cases = card.matrix.cases
    rows = [
        _row(f"`{cases[place].fault.words}`", card.protected[place], card.bare[place] if card.bare else None)
        for place in places
    ]
    bare = merge_outcomes([card.bare[place] for place in places]) if card.bare else None
    return [*rows, _row("all", merge_outcomes([card.protected[place] for place in places]), bare)]


def _row(name: str, found: Outcomes, bare: Outcomes | None) -> list[str]:
    return [
        name,
        str(found.flights),
        str(found.acted),
        "-" if found.passed is None else str(found.passed),
        str(found.safe),
        str(found.lost),
        str(found.wrong),
        f"{found.wrong_at_most:.4f}",
        _first_alarm(found),
        "-" if found.delay is None else f"{found.delay:.1f}",
        "-" if bare is None else str(bare.safe),
        "-" if bare is None else str(bare.wrong),
    ]


def _first_alarm(found: Outcomes) -> str:
    return (
        ", ".join(f"{kind.name.lower().replace('_', ' ')} {count}" for kind, count in found.alarms[:3]) or "-"
    )


def _table(rows: Sequence[Sequence[str]]) -> str:
    lines = [HEADS, ["---"] * len(HEADS), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
