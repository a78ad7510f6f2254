"""Faults in a flight log: injected faults, occurrences and effects."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import TypeAdapter

from flight.errors import BadFileError
from flight.mission.fault import Fault
from flight.schema import parse_json

from .attachment_names import FAULTS_ATTACHMENT
from .log import FlightLog
from .topics import FAULT, FAULT_EFFECT

_FAULTS = TypeAdapter(tuple[Fault, ...])


def faults_text(faults: Sequence[Fault]) -> bytes:
    """Returns faults as the log's attachment."""
    return _FAULTS.dump_json(tuple(faults), indent=1)


def logged_faults(log: FlightLog) -> tuple[Fault, ...]:
    """Returns the faults injected into a logged flight.

    Raises:
        BadFileError: the attachment is invalid.
    """
    text = log.attachments.get(FAULTS_ATTACHMENT)
    return () if text is None else parse_json(text, FAULTS_ATTACHMENT, tuple[Fault, ...])


@dataclass(frozen=True, slots=True)
class FaultOccurrence:
    """Occurrence of a fault: its times in seconds and largest effect.

    Attributes:
        fault: the injected fault.
        start: logged start.
        end: logged end; the end of the log if the fault lasted.
        effect: largest effect, in the unit of the kind.
    """

    fault: Fault
    start: float
    end: float
    effect: float

    @property
    def sentence(self) -> str:
        """Kind, sizes, end and effect as text."""
        kind = self.fault.kind
        sizes = " ".join(
            f"{value:g} {size.unit}".removesuffix(" -")
            for value, size in zip(self.fault.size, kind.sizes, strict=True)
        )
        by = f" ({sizes})" if sizes else ""
        unit = f" {kind.unit}".removesuffix(" -")
        return f"{kind.where} {kind.what}{by} until {self.end:.2f} s; {kind.effect}: {self.effect:.3g}{unit}"


def fault_occurrences(log: FlightLog) -> dict[int, FaultOccurrence]:
    """Returns the faults that began in a flight, by number.

    Raises:
        BadFileError: the log's list of faults is invalid or lacks a fault that began.
    """
    if FAULT.name not in log.series:
        return {}
    faults, rows, found = logged_faults(log), log[FAULT], {}
    numbers, active = rows["number"], rows["active"] > 0.0
    for start, number in zip(rows.time[active].tolist(), numbers[active].astype(int).tolist(), strict=True):
        if not 1 <= number <= len(faults):
            raise BadFileError(FAULTS_ATTACHMENT, f"expected fault {number}, got {len(faults)} faults")
        ends = rows.time[~active & (numbers == number)].tolist()
        found[number] = FaultOccurrence(
            fault=faults[number - 1],
            start=start,
            end=ends[0] if ends else log.duration,
            effect=_largest_effect(log, number),
        )
    return found


def fault_effects(log: FlightLog) -> tuple[float, ...]:
    """Returns each fault's largest effect; 0 if it did not begin.

    Raises:
        BadFileError: the log's list of faults is invalid or lacks a fault that began.
    """
    occurrences = fault_occurrences(log)
    return tuple(
        occurrences[number].effect if number in occurrences else 0.0
        for number, _ in enumerate(logged_faults(log), start=1)
    )


def _largest_effect(log: FlightLog, number: int) -> float:
    if FAULT_EFFECT.name not in log.series:
        return 0.0
    rows = log[FAULT_EFFECT]
    return float(np.abs(rows["effect"][rows["number"] == number]).max(initial=0.0))
