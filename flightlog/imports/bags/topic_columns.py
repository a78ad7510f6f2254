"""Numbers of the messages of one topic, gathered while they are read."""

from array import array
from collections.abc import Sequence
from datetime import datetime
from typing import Any

import numpy as np
from jaxtyping import Float, Real

from flightlog.consistency import LARGEST_VALUE
from flightlog.imports.mcap_messages import (
    ANGULAR,
    LINEAR,
    POSITION,
    Nanoseconds,
    VectorPath,
    child_frame_of,
    find_quaternion,
    find_vector,
    frame_of,
    number_of,
    stamp_of,
)

VECTORS = ("position", "attitude", "linear", "angular")
"""Vectors that are looked for in a message, by what they are."""

SCALARS = ("latitude", "longitude", "altitude", "reset_counter", "velocity_frame", "pose_frame")
LOCAL_POSITION = (
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
    "heading",
    "xy_valid",
    "z_valid",
    "v_xy_valid",
    "v_z_valid",
)
COUNTERS = (
    "xy_reset_counter",
    "z_reset_counter",
    "vxy_reset_counter",
    "vz_reset_counter",
    "heading_reset_counter",
)

# Messages in which a vector is looked for before it counts as absent.
_SEARCHED = 200


class TopicColumns:
    """Numbers of one topic.

    Attributes:
        schema: type of the messages.
        frame: frame of the messages; empty without one.
        children: child frames by number of messages.
        bad: messages that could not be decoded.
        paths: where each vector is.
    """

    def __init__(self, topic: str, schema: str, child: str | None) -> None:
        """Starts without messages.

        Args:
            topic: name of the topic.
            schema: type of its messages.
            child: child frame to keep; all if None.
        """
        self.topic, self.schema, self._child = topic, schema, child
        self.frame, self.children, self.bad = "", dict[str, int](), 0
        self.paths: dict[str, VectorPath] = {}
        self._count = 0
        self._logged, self._stamps = array("q"), list[Any]()
        self._vectors: dict[str, array[float]] = {}
        self._scalars: dict[str, array[float]] = {}

    def __len__(self) -> int:
        return self._count

    @property
    def px4(self) -> bool:
        """True for PX4's messages."""
        return self.schema.startswith("px4_msgs/")

    def add(self, message: Any, logged: int) -> None:
        """Takes the numbers of a message."""
        child = child_frame_of(message)
        if self._child is not None and child != self._child:
            self.children[child] = self.children.get(child, 0) + 1
            return
        self.children[child] = self.children.get(child, 0) + 1
        self.frame = self.frame or frame_of(message)
        if self._count < _SEARCHED:
            self._search(message)
        stamp = stamp_of(message)
        self._stamps.append(stamp)
        self._logged.append(logged)
        for name, path in self.paths.items():
            self._vectors[name].extend(path.numbers(message))
        for name, column in self._scalars.items():
            column.append(number_of(message, name))
        self._count += 1

    def vectors(self, name: str) -> Float[np.ndarray, "n k"] | None:
        """Returns a vector of all messages; None if they have none."""
        if name not in self.paths:
            return None
        found = np.array(self._vectors[name]).reshape(self._count, -1)
        return np.where(np.abs(found) < LARGEST_VALUE, found, np.nan)

    def scalar(self, name: str) -> Float[np.ndarray, "n"] | None:
        """Returns a number of all messages; None if they have none."""
        return np.array(self._scalars[name]) if name in self._scalars else None

    def logged(self) -> Float[np.ndarray, "n"]:
        """Returns log times, seconds since the first."""
        times = np.array(self._logged, np.int64)
        return (times - times[:1]) * 1e-9

    def log_start(self) -> int:
        """Returns the first log time, nanoseconds."""
        return int(self._logged[0])

    def stamps(self) -> tuple[Real[np.ndarray, "n"], str] | None:
        """Returns stamps and their unit, `ns`, `us`, `text` or `?`, if any."""
        given = [stamp for stamp in self._stamps if stamp is not None]
        if not given:
            return None
        if all(isinstance(stamp, str) for stamp in given):
            return np.array([_nanoseconds(stamp) for stamp in self._stamps]), "text"
        plain = [np.nan if stamp is None or isinstance(stamp, str) else stamp for stamp in self._stamps]
        exact = all(isinstance(stamp, int) for stamp in plain)
        numbers = np.array(plain, np.int64 if exact and max(map(abs, plain)) < 2**63 else np.float64)
        if isinstance(given[0], Nanoseconds):
            return np.where(numbers > 0, numbers, np.nan) if (numbers <= 0).any() else numbers, "ns"
        return numbers, "us" if self.px4 else "?"

    def _search(self, message: Any) -> None:
        finders: Sequence[tuple[str, Any]] = (
            ("position", find_vector(message, POSITION)),
            ("attitude", find_quaternion(message)),
            ("linear", find_vector(message, LINEAR)),
            ("angular", find_vector(message, ANGULAR)),
        )
        for name, path in finders:
            if path is not None and name not in self.paths:
                self.paths[name] = path
                self._vectors[name] = array("d", [np.nan] * (len(path.axes) * self._count))
        wanted: Sequence[str] = SCALARS
        if self.schema.endswith("VehicleLocalPosition"):
            wanted = (*SCALARS, *LOCAL_POSITION, *COUNTERS)
        for name in wanted:
            if name not in self._scalars and not np.isnan(number_of(message, name)):
                self._scalars[name] = array("d", [np.nan] * self._count)


def _nanoseconds(stamp: str | None) -> float:
    try:
        moment = datetime.fromisoformat(stamp or "")
    except ValueError:
        return np.nan
    return moment.timestamp() * 1e9
