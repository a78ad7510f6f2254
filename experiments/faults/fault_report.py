"""Report of a fault matrix as Markdown and CSV."""

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
    """Outcomes of all flights of one fault, with or without protection.

    Attributes:
        flights: number of flights.
        acted: flights in which the fault had an effect.
        passed: flights that reached the goal and declared it, inside the safe envelope, without an alarm;
            None outside the contract.
        safe: flights inside the envelope without a false declaration of arrival.
        detected_loss: flights that left the envelope with an alarm in time.
        undetected_failure: flights that left it without an alarm in time, or declared arrival and missed the
            goal.
        alarms: flights by their first alarm.
        delay: median seconds from the fault's start to the first alarm; None without one.
    """

    flights: int
    acted: int
    passed: int | None
    safe: int
    detected_loss: int
    undetected_failure: int
    alarms: tuple[tuple[AlarmKind, int], ...]
    delay: float | None

    @property
    def undetected_failure_at_most(self) -> float:
        """Upper 95 % limit of the share of undetected failures (Clopper-Pearson)."""
        if self.flights == 0:
            return 1.0
        test = binomtest(self.undetected_failure, self.flights, alternative="less")
        return float(test.proportion_ci(CONFIDENCE, method="exact").high)


def count_outcomes(case: FaultCase, rows: Sequence[MissionResult]) -> Outcomes:
    """Counts the outcomes of a fault's flights."""
    outcomes = Counter(outcome_of(row) for row in rows)
    firsts = [min(row.serious_alarms, key=lambda alarm: alarm.time) for row in rows if row.serious_alarms]
    passed = [
        row for row in rows if row.reached and outcome_of(row) is Outcome.SAFE and not row.serious_alarms
    ]
    return Outcomes(
        flights=len(rows),
        acted=sum(map(all_faults_acted, rows)),
        passed=len(passed) if case.contract else None,
        safe=outcomes[Outcome.SAFE],
        detected_loss=outcomes[Outcome.DETECTED_LOSS],
        undetected_failure=outcomes[Outcome.UNDETECTED_FAILURE],
        alarms=tuple(Counter(alarm.kind for alarm in firsts).most_common()),
        delay=median(alarm.time - case.fault.start for alarm in firsts) if firsts else None,
    )


def merge_outcomes(parts: Sequence[Outcomes]) -> Outcomes:
    """Sums the outcomes of several faults."""
    alarms: Counter[AlarmKind] = Counter()
    for part in parts:
        alarms.update(dict(part.alarms))
    passed = [part.passed for part in parts if part.passed is not None]
    return Outcomes(
        flights=sum(part.flights for part in parts),
        acted=sum(part.acted for part in parts),
        passed=sum(passed) if len(passed) == len(parts) else None,
        safe=sum(part.safe for part in parts),
        detected_loss=sum(part.detected_loss for part in parts),
        undetected_failure=sum(part.undetected_failure for part in parts),
        alarms=tuple(alarms.most_common()),
        delay=None,
    )


@dataclass(frozen=True, slots=True)
class FaultReport:
    """Results of a fault matrix.

    Attributes:
        command: command that reproduces it.
        matrix: the fault matrix.
        protected: outcomes of each case with protection.
        bare: outcomes of each case without protection; empty where not flown.
        sound: outcomes of the same missions without a fault.
    """

    command: str
    matrix: FaultMatrix
    protected: tuple[Outcomes, ...]
    bare: tuple[Outcomes, ...]
    sound: Outcomes

    @property
    def acceptable(self) -> bool:
        """True without undetected failures if every fault acted in every flight."""
        whole = merge_outcomes(self.protected)
        return (
            whole.undetected_failure == 0
            and whole.acted == whole.flights
            and self.sound.undetected_failure == 0
        )


NOTES = """`acted`: flights in which the log's `/fault_effect` shows the fault. `passed`, inside the contract
only: reached the goal and declared arrival inside the envelope without an alarm. `safe`: inside the envelope,
and no arrival declared away from the goal; a flight that gives up is safe. `detected loss`: left the
envelope, with an alarm at most one second later. `undetected failure`: left the envelope without such an
alarm, or declared arrival away from the goal. `at most`: upper 95 % limit of the share of undetected failures
(Clopper-Pearson). Without protection there are no alarms, and arrival is declared by the estimate alone. No
flight outside the contract counts as passed."""

HEADS = (
    *("fault", "flights", "acted", "passed", "safe", "detected loss", "undetected failure", "at most"),
    *("first alarm", "after, s", "without protection: safe", "undetected failure"),
)


def fault_markdown(card: FaultReport) -> str:
    """Returns the results as a Markdown page."""
    inside = [place for place, case in enumerate(card.matrix.cases) if case.contract]
    outside = [place for place, case in enumerate(card.matrix.cases) if not case.contract]
    envelope = card.matrix.envelope
    parts = [
        f"# Fault matrix, {card.matrix.name}",
        f"    {card.command}",
        f"Safe envelope: roll and pitch within {envelope.tilt:g} rad, height within {envelope.height:g} m, "
        f"estimated position within {envelope.position:g} m and heading within {envelope.heading:g} rad of "
        "the true ones.",
        NOTES,
        "## No fault",
        _table([_row("no fault", card.sound, None)]),
        *_section("## Inside the contract: the mission goes on", card, inside),
        *_section("## Outside the contract: every loss is detected", card, outside),
        "## Expected behaviour",
        "\n".join(f"- `{case.fault.words}`: {case.expected}" for case in card.matrix.cases),
    ]
    return "\n\n".join(parts) + "\n"


def fault_csv(card: FaultReport) -> str:
    """Returns the results as CSV, a line per fault and protection."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    heads = (
        *("flights", "acted", "passed", "safe", "detected_loss", "undetected_failure"),
        *("undetected_failure_at_most", "first_alarm", "delay"),
    )
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
                *(found.detected_loss, found.undetected_failure),
                *(f"{found.undetected_failure_at_most:.4f}", _first_alarm(found)),
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
        str(found.detected_loss),
        str(found.undetected_failure),
        f"{found.undetected_failure_at_most:.4f}",
        _first_alarm(found),
        "-" if found.delay is None else f"{found.delay:.1f}",
        "-" if bare is None else str(bare.safe),
        "-" if bare is None else str(bare.undetected_failure),
    ]


def _first_alarm(found: Outcomes) -> str:
    return (
        ", ".join(f"{kind.name.lower().replace('_', ' ')} {count}" for kind, count in found.alarms[:3]) or "-"
    )


def _table(rows: Sequence[Sequence[str]]) -> str:
    lines = [HEADS, ["---"] * len(HEADS), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
