"""Sources of PX4's vehicle_local_position, each with its own validity."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from flightlog.imports.measured_motion import Source

Column = Float[np.ndarray, "n"]

# Fields that share a validity flag, and their names in a source.
_GROUPS = (
    ("xy_valid", {"x": "north", "y": "east"}),
    ("z_valid", {"z": "down"}),
    ("v_xy_valid", {"vx": "velocity_north", "vy": "velocity_east"}),
    ("v_z_valid", {"vz": "velocity_down"}),
)
LEAST_VALID = 0.1
"""Smallest share of valid samples; fields below it are absent."""


def local_position_sources(time: Column, fields: Mapping[str, np.ndarray[Any, Any]]) -> list[Source]:
    """Returns positions and velocities where PX4 marks them as valid.

    Args:
        time: seconds.
        fields: fields of the messages; a flag that is not logged is true.
    """
    sources = []
    for flag, names in _GROUPS:
        if not names.keys() <= fields.keys():
            continue
        valid = _flag(fields, flag, len(time))
        if valid.mean() >= LEAST_VALID:
            # Damaged single-precision numbers may be signalling.
            with np.errstate(invalid="ignore"):
                columns = {ours: np.asarray(fields[name], np.float64)[valid] for name, ours in names.items()}
            sources.append(Source(time[valid], columns))
    if "heading" in fields and sources:
        with np.errstate(invalid="ignore"):
            sources.append(Source(time, {"heading": np.asarray(fields["heading"], np.float64)}))
    return sources


def _flag(fields: Mapping[str, np.ndarray[Any, Any]], name: str, count: int) -> Bool[np.ndarray, "n"]:
    return np.asarray(fields[name], bool) if name in fields else np.ones(count, bool)
