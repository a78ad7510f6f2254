"""Outcome of a flight with a fault."""

from enum import StrEnum

from experiments.mission.result import MissionResult

GRACE = 1.0
"""Largest delay of an alarm after leaving the safe envelope, seconds."""


class Outcome(StrEnum):
    """Outcome of a flight: truth compared with alarms and declared arrival."""

    SAFE = "safe"
    DETECTED_LOSS = "detected loss"
    UNDETECTED_FAILURE = "undetected failure"


def outcome_of(row: MissionResult) -> Outcome:
    """Returns the outcome of a flight.

    An undetected failure declares arrival away from the goal, or leaves the safe envelope without an alarm in
    time; a flight that gives up inside the envelope is safe.
    """
    if row.claimed and not row.reached:
        return Outcome.UNDETECTED_FAILURE
    if row.left is None:
        return Outcome.SAFE
    alarmed = min((alarm.time for alarm in row.serious_alarms), default=None)
    return (
        Outcome.DETECTED_LOSS
        if alarmed is not None and alarmed <= row.left.time + GRACE
        else Outcome.UNDETECTED_FAILURE
    )


def all_faults_acted(row: MissionResult) -> bool:
    """Returns True if every fault of a flight had an effect."""
    return bool(row.effects) and all(effect > 0 for effect in row.effects)
