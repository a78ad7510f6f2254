"""What a flight in which something was wrong came to: safe, lost and said so, or wrong."""

from enum import StrEnum

from experiments.mission.result import MissionResult

GRACE = 1.0
"""Seconds after leaving the safe envelope within which a vehicle must have said that something is wrong."""


class Outcome(StrEnum):
    """What is true of a flight, beside what the vehicle said of it."""

    SAFE = "safe"
    DETECTED_LOSS = "lost and said so"
    UNDETECTED_FAILURE = "wrong"


def outcome_of(row: MissionResult) -> Outcome:
    """Returns what a flight came to.

    `wrong` is whoever says to be at the goal and is not, or leaves the safe envelope and does not say so in
    time; a flight that ends without the goal, and says that, inside the envelope, is `safe`.
    """
    if row.claimed and not row.reached:
        return Outcome.UNDETECTED_FAILURE
    if row.left is None:
        return Outcome.SAFE
    said = min((alarm.time for alarm in row.serious_alarms), default=None)
    return (
        Outcome.DETECTED_LOSS
        if said is not None and said <= row.left.time + GRACE
        else Outcome.UNDETECTED_FAILURE
    )


def all_faults_acted(row: MissionResult) -> bool:
    """Returns whether every fault of a flight was seen to act."""
    return bool(row.effects) and all(effect > 0 for effect in row.effects)
