"""Mutations of files: random bytes or structured changes."""

import json
import tomllib
from collections.abc import Callable
from dataclasses import asdict, replace
from random import Random
from typing import Any
from unittest.mock import patch
from xml.etree import ElementTree

import numpy as np

from flight.errors import FlightError
from flightlog.file.writer import log_bytes
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.series import Series

HOSTILE: tuple[Any, ...] = (
    *(float("nan"), float("inf"), -float("inf"), -1, 0, 1e308, -1e-320, 10**400, 2**63, -(2**31)),
    *("", "x" * 100_000, "../../etc/passwd", "\x00", "\ud83d\ude00", "NaN", "1e5", None, True, False),
    *([], {}, [[]], [1, 2, 3], {"a": 1}, [None] * 1000),
)
_DEEP = 20_000


def changed_bytes(content: bytes, chance: Random) -> bytes:
    """Returns bytes flipped, cut, repeated, inserted or zeroed."""
    place = chance.randrange(len(content) + 1)
    length = min(chance.choice((1, 2, 8, 64, 4096)), len(content) - place)
    before, part, after = content[:place], content[place : place + length], content[place + length :]
    kind = chance.randrange(6)
    if kind == 0:
        flipped = bytes(byte ^ (1 << chance.randrange(8)) for byte in part)
        return before + flipped + after
    if kind == 1:
        return before
    if kind == 2:
        return before + after
    if kind == 3:
        return before + part * chance.choice((2, 100)) + after
    if kind == 4:
        return before + chance.randbytes(chance.choice((1, 16, 1000))) + part + after
    return before + bytes(length) + after


def changed_json(content: bytes, chance: Random) -> bytes:
    """Returns a JSON file with a changed tree."""
    if chance.random() < 0.02:
        return b"[" * _DEEP + b"]" * _DEEP
    return json.dumps(_changed_tree(json.loads(content), chance)).encode("utf-8", "surrogatepass")


def changed_toml(content: bytes, chance: Random) -> bytes:
    """Returns a TOML file with a changed tree."""
    return _toml(_changed_tree(tomllib.loads(content.decode()), chance)).encode("utf-8", "surrogatepass")


def changed_xml(content: bytes, chance: Random) -> bytes:
    """Returns an XML file with changed elements, attributes or entities."""
    root = ElementTree.fromstring(content)
    part = chance.choice(list(root.iter()))
    words = chance.choice(("nan", "inf", "-1e999", "1e308", "", "/etc/passwd", "../../x", "0 0", "x" * 9999))
    kind = chance.randrange(5)
    if kind == 0 and part.attrib:
        part.set(chance.choice(sorted(part.attrib)), words)
    elif kind == 1:
        part.set(chance.choice(("file", "meshdir", "name", "count", "size")), words)
    elif kind == 2:
        part.tag = chance.choice(("include", "mesh", "plugin", "replicate", "composite", "geom", "body"))
    elif kind == 3:
        for _ in range(chance.choice((1, 50, 400))):
            part = ElementTree.SubElement(part, chance.choice(("body", "geom", "include")))
    text = ElementTree.tostring(root)
    entity = b'<!DOCTYPE m [<!ENTITY a "aaaaaaaaaa"><!ENTITY b SYSTEM "file:///etc/passwd">]>'
    return entity + text if kind == 4 else text


def changed_log(log: FlightLog, chance: Random) -> bytes:
    """Returns a changed flight log with correct checksums.

    Logs whose viewer channels cannot be made are written without them, as by another writer.
    """
    while True:
        try:
            changed = chance.choice(_LOG_CHANGES)(log, chance)
            try:
                return log_bytes(changed)
            except (ValueError, ArithmeticError, IndexError, FlightError):
                with patch("flightlog.file.writer.viewer_channels", return_value=()):
                    return log_bytes(changed)
        except (ValueError, ArithmeticError, IndexError, FlightError):
            continue


def _without_topic(log: FlightLog, chance: Random) -> FlightLog:
    name = chance.choice(sorted(log.series))
    return replace(log, series={key: part for key, part in log.series.items() if key != name})


def _with_changed_values(log: FlightLog, chance: Random) -> FlightLog:
    name = chance.choice(sorted(log.series))
    series = log.series[name]
    values = series.values.copy()
    place = chance.randrange(values.shape[0]), chance.randrange(values.shape[1])
    values[place] = chance.choice((np.nan, np.inf, -np.inf, 1e308, -1.0, 1e18))
    return replace(log, series={**log.series, name: Series(series.topic, series.time, values)})


def _with_changed_times(log: FlightLog, chance: Random) -> FlightLog:
    name = chance.choice(sorted(log.series))
    series = log.series[name]
    time = chance.choice((np.zeros_like(series.time), series.time + 500.0, np.sort(chance_times(series))))
    return replace(log, series={**log.series, name: Series(series.topic, time, series.values)})


def chance_times(series: Series) -> np.ndarray:
    """Returns as many random times between first and last."""
    return np.random.default_rng(len(series)).uniform(0, max(float(series.time[-1]), 1.0), len(series))


def _cut_short(log: FlightLog, chance: Random) -> FlightLog:
    name, count = chance.choice(sorted(log.series)), chance.choice((1, 2, 5))
    series = log.series[name]
    short = Series(series.topic, series.time[:count], series.values[:count])
    return replace(log, series={**log.series, name: short})


def _with_changed_attachment(log: FlightLog, chance: Random) -> FlightLog:
    name = chance.choice(sorted(log.attachments))
    content = log.attachments[name]
    change = changed_json if name.endswith(".json") and chance.random() < 0.7 else changed_bytes
    return replace(log, attachments={**log.attachments, name: change(content, chance)})


def _with_changed_header(log: FlightLog, chance: Random) -> FlightLog:
    words = chance.choice(("", "x" * 10_000, "[bold]", "\x1b[31m", "completed\nmaneuver: fine", "no such"))
    header = asdict(log.header)
    header[chance.choice(sorted(header.keys() - {"seed"}))] = words
    return replace(log, header=FlightHeader(**header))


_LOG_CHANGES: tuple[Callable[[FlightLog, Random], FlightLog], ...] = (
    _without_topic,
    _with_changed_values,
    _with_changed_times,
    _cut_short,
    _with_changed_attachment,
    _with_changed_header,
)


def _changed_tree(tree: Any, chance: Random) -> Any:
    places = list(_places(tree))
    container, key = chance.choice(places)
    kind = chance.randrange(4)
    if kind == 0:
        container[key] = chance.choice(HOSTILE)
    elif kind == 1:
        del container[key]
    elif kind == 2:
        other, place = chance.choice(places)
        container[key] = json.loads(json.dumps(other[place]))
    elif isinstance(container, list):
        container.insert(chance.randrange(len(container) + 1), container[key])
    else:
        container[chance.choice(("extra", "schema", "id", str(key) * 2))] = chance.choice(HOSTILE)
    return tree


def _places(tree: Any) -> Any:
    entries = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, value in list(entries):
        yield tree, key
        yield from _places(value)


def _toml(tree: Any) -> str:
    if not isinstance(tree, dict):
        return f"value = {_toml_value(tree)}\n"
    return "".join(f"{json.dumps(str(key))} = {_toml_value(value)}\n" for key, value in tree.items())


def _toml_value(value: Any) -> str:
    if isinstance(value, dict):
        inside = (f"{json.dumps(str(key))} = {_toml_value(part)}" for key, part in value.items())
        return "{" + ", ".join(inside) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml_value, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return "null" if value is None else json.dumps(value)
