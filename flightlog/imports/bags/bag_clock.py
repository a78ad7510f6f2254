"""Clock of a bag: stamps of the messages, or log times."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float, Real

from flightlog.imports.clock import SECONDS, ClockError, Part, TimeUnit, order_by_time

from .topic_columns import TopicColumns

# Stamps that may be missing, as a share.
_MISSING = 0.01
# Largest ratio of the spans of stamps and log times.
_LIKE = 1.5
# Largest difference of the delays of two topics, seconds.
_TOGETHER = 60.0
# Least stamp of a date, seconds since 1970: the year 2001.
_DATE = 1e9

Column = Float[np.ndarray, "n"]


def clocks_of(tables: Mapping[str, TopicColumns], part: int | None) -> tuple[dict[str, Part], str]:
    """Returns each topic's messages in order of one clock, and its name.

    Args:
        tables: messages by topic.
        part: number of the part, where there are several.

    Raises:
        ClockError: the clock is that of no flight.
    """
    stamped = {name: _stamps(table) for name, table in tables.items()}
    lacking = [name for name, stamps in stamped.items() if stamps is None]
    logged = {name: table.log_start() * 1e-9 + table.logged() for name, table in tables.items()}
    start = min(table.log_start() for table in tables.values())
    by_log = {name: (table.log_start() - start) * 1e-9 + table.logged() for name, table in tables.items()}
    if lacking:
        return _ordered(by_log, part), "of logging, as messages have no stamps" if not part else "of logging"
    own = {name: stamps for name, stamps in stamped.items() if stamps is not None}
    delays = [float(np.nanmedian(logged[name] - stamps)) for name, stamps in own.items()]
    if max(delays) - min(delays) > _TOGETHER:
        return _ordered(by_log, part), "of logging, as the topics have stamps of different clocks"
    first = min(float(np.nanmin(stamps)) for stamps in own.values())
    try:
        return _ordered({name: stamps - first for name, stamps in own.items()}, part), "of the messages"
    except ClockError as error:
        try:
            return _ordered(by_log, part), "of logging, as the stamps are those of no single flight"
        except ClockError:
            raise error from None


def _ordered(times: Mapping[str, Column], part: int | None) -> dict[str, Part]:
    parts = {name: order_by_time(time, sample=f"{name} message", part=part) for name, time in times.items()}
    return parts


def _stamps(table: TopicColumns) -> Column | None:
    """Returns the stamps in seconds; None if they cannot be used."""
    found = table.stamps()
    if found is None:
        return None
    numbers, unit = found
    finite = np.isfinite(numbers)
    if finite.mean() < 1.0 - _MISSING or (len(numbers) > 1 and not np.ptp(numbers[finite])):
        return None
    if unit in {"ns", "text"}:
        return np.asarray(numbers * 1e-9)
    if unit == "us":
        return np.asarray(numbers * 1e-6)
    size = _size(numbers[finite], table.logged())
    return None if size is None else np.asarray(numbers * size)


def _size(numbers: Real[np.ndarray, "n"], logged: Float[np.ndarray, "m"]) -> float | None:
    """Returns the unit of stamps by dates or log times, if clear."""
    middle, span, logging = float(np.median(numbers)), float(np.ptp(numbers)), float(np.ptp(logged))
    units: tuple[TimeUnit, ...] = ("s", "ms", "us", "ns")
    dates = [SECONDS[unit] for unit in units if _DATE < SECONDS[unit] * middle < 4.0 * _DATE]
    alike = [
        SECONDS[unit]
        for unit in units
        if logging > 0.0 and 1.0 / _LIKE < SECONDS[unit] * span / logging < _LIKE
    ]
    if dates and (not alike or dates[0] in alike):
        return dates[0]
    return alike[0] if alike else None
