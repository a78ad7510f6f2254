"""Files of other programs to mutate, and their import."""

from collections.abc import Callable
from pathlib import Path
from random import Random

import numpy as np

from flightlog.topics import TRUTH
from maneuver.app import run
from tests.support.external.circle_bag import json_bag, messages_of
from tests.support.external.dataflash_writer import dataflash
from tests.support.external.flown_circle import TIME, table, text
from tests.support.external.ulog_writer import ulog
from tests.support.external_bags import ros2_bag
from tests.support.synthetic_log import synthetic_library, synthetic_log

from .hostile_files import Kind
from .mutations import changed_bytes

_CELLS = (
    "",
    "nan",
    "inf",
    "-1",
    "1e308",
    "1e-320",
    "x",
    '"',
    "'",
    "0x10",
    "1,5",
    "\x00",
    "9" * 400,
    "10:00:00",
)


def kinds_of_imports() -> tuple[Kind, ...]:
    """Returns a good file of each kind that is imported."""
    flown = synthetic_log(synthetic_library(), (1, 2), (3.0, 3.0), seed=1)[TRUTH]
    return (
        Kind("table", text(table()).encode(), ".csv", _import(), changed_table),
        Kind(
            "JSON bag", json_bag(messages_of(range(300))), ".mcap", _import("--pose", "/odom"), changed_bytes
        ),
        Kind(
            "ROS 2 bag", ros2_bag(flown, topics=["/odom"]), ".mcap", _import("--pose", "/odom"), changed_bytes
        ),
        Kind("ULog", _small_ulog(), ".ulg", _import(), changed_bytes),
        Kind("DataFlash log", dataflash(), ".bin", _import(), changed_bytes),
    )


def changed_table(content: bytes, chance: Random) -> bytes:
    """Returns a table with cells, rows or marks changed."""
    rows = [row.split(b",") for row in content.split(b"\n")]
    for _ in range(chance.choice((1, 3, 30))):
        row = chance.choice(rows)
        kind = chance.randrange(5)
        if kind == 0:
            row[chance.randrange(len(row))] = chance.choice(_CELLS).encode()
        elif kind == 1:
            row.append(chance.choice(_CELLS).encode())
        elif kind == 2:
            del row[chance.randrange(len(row)) :]
            row.append(b"")
        elif kind == 3:
            chance.shuffle(row)
        else:
            rows.insert(chance.randrange(len(rows)), list(row))
    mark = chance.choice((b",", b",", b";", b"\t", b"|"))
    return b"\n".join(mark.join(row) for row in rows)


def _import(*words: str) -> Callable[[Path], int]:
    def use(path: Path) -> int:
        return run(["import", str(path), *words, "--out", str(path.parent / "imported.mcap"), "--force"])

    return use


def _small_ulog() -> bytes:
    time, columns = TIME[::10], table()
    stamp = ("uint64_t", 1e6 * (time + 1.0))
    numbers = {name: ("float", columns[name][::10]) for name in ("x", "y", "z", "vx", "vy", "vz")}
    half = 0.5 * columns["yaw"][::10]
    turned = {
        "q[0]": ("float", np.cos(half)),
        **{f"q[{place}]": ("float", 0.0 * half) for place in (1, 2)},
        "q[3]": ("float", np.sin(half)),
    }
    return ulog(
        {
            "vehicle_local_position": {"timestamp": stamp, **numbers},
            "vehicle_attitude": {"timestamp": stamp, **turned},
        }
    )
