"""Logs with topics or attachments changed, added or removed."""

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flightlog.log import FlightLog
from flightlog.topic import Topic


def with_changed_topic(
    log: FlightLog, topic: Topic, change: Callable[[NDArray[np.float64]], None]
) -> FlightLog:
    """Returns the log with the values of a topic changed in place."""
    values = log[topic].values.copy()
    change(values)
    return replace(log, series={**log.series, topic.name: replace(log[topic], values=values)})


def with_added_offset(log: FlightLog, topic: Topic, field: str, amount: float) -> FlightLog:
    def change(values: NDArray[np.float64]) -> None:
        values[:, topic.field_names.index(field)] += amount

    return with_changed_topic(log, topic, change)


def with_attachment(log: FlightLog, name: str, content: object) -> FlightLog:
    return replace(log, attachments={**log.attachments, name: json.dumps(content).encode()})


def without_topics(log: FlightLog, *topics: Topic) -> FlightLog:
    gone = {topic.name for topic in topics}
    return replace(log, series={name: part for name, part in log.series.items() if name not in gone})
