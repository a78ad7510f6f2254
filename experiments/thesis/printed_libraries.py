"""Libraries of the thesis from its printed tables.

`printed/` has one CSV per table, uncorrected. Rows that contradict the rest of their table have a note in the
library.
"""

import csv
import hashlib
from collections.abc import Iterator, Mapping
from decimal import Decimal
from math import radians
from pathlib import Path

from flight.automaton.conditions import Conditions
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist

TABLES = Path(__file__).parent / "printed"

# International foot, exact by definition.
METRES_PER_FOOT = Decimal("0.3048")

Row = Mapping[str, str]

KINEMATIC_NOTES = {
    number: "the signs of this row's errors follow no rule of the others" for number in range(13, 19)
}

GTMAX_NOTES = {
    11: "the sign of the lateral error differs from the rule that every other row follows",
    15: "the edge is 3-3 in Table 4 and 3-7 in Table 10; Table 10 gives the counts of Table 11",
    16: "the edge is 7-7 in Table 4 and 7-3 in Table 10; Table 10 gives the counts of Table 11",
    17: "suspect: lateral displacement near zero, where the kinematics gives about 10 ft",
    18: "suspect: lateral displacement near zero, where the kinematics gives about 10 ft",
    21: "suspect: positive heading change in a left turn; the mirror row 19 shows that it should be negative",
    22: "suspect: positive heading change in a left turn; the mirror row 20 shows that it should be negative",
}


def thesis_kinematic() -> Library:
    """Returns the library of Tables 7 and 8, in metres."""
    trims, maneuvers = "tables_1_7_kinematic_trims.csv", "tables_2_5_6_8_kinematic_maneuvers.csv"
    return Library(
        name="thesis-kinematic",
        description="The thesis's reference library from kinematics, Tables 7 and 8 as printed",
        vehicle="planar kinematic model",
        trims=tuple(map(_kinematic_trim, _rows(trims))),
        maneuvers=tuple(map(_kinematic_maneuver, _rows(maneuvers))),
        conditions=Conditions(trim_error_kind="assumed"),
        provenance=_provenance("Tables 7 and 8", trims, maneuvers),
    )


def thesis_gtmax() -> Library:
    """Returns the library of Tables 9 and 10, converted to metres."""
    trims, maneuvers = "tables_3_9_gtmax_trims.csv", "table_10_gtmax_maneuvers.csv"
    return Library(
        name="thesis-gtmax",
        description="The thesis's library from GT-Max simulations, Tables 9 and 10 as printed, in metres",
        vehicle="GT-Max",
        trims=tuple(map(_gtmax_trim, _rows(trims))),
        maneuvers=tuple(map(_gtmax_maneuver, _rows(maneuvers))),
        conditions=Conditions(trim_error_kind="instantaneous"),
        provenance=_provenance("Tables 9 and 10", trims, maneuvers),
    )


def _kinematic_trim(row: Row) -> Trim:
    velocity = {
        "forward": Decimal(row["u_fwd_m_per_s"]),
        "side": Decimal(row["u_side_m_per_s"]),
        "yaw_rate": Decimal(row["yaw_rate_rad_per_s"]),
    }
    percent = {
        "forward": Decimal(row["error_u_fwd_percent"]),
        "side": Decimal(row["error_u_side_percent"]),
        "yaw_rate": Decimal(row["error_yaw_rate_percent"]),
    }
    # Adding 0 changes -0.0 into 0.0.
    error = {name: float(percent[name] / 100 * velocity[name]) + 0.0 for name in velocity}
    return Trim(
        id=int(row["trim"]),
        name=row["description"],
        velocity=Twist(**{name: float(value) for name, value in velocity.items()}),
        error=Twist(**error),
    )


def _kinematic_maneuver(row: Row) -> Maneuver:
    number = int(row["maneuver"])
    return Maneuver(
        id=number,
        from_trim=int(row["from"]),
        to_trim=int(row["to"]),
        duration=float(row["duration_s"]),
        displacement=SE2(float(row["dx_m"]), float(row["dy_m"]), radians(float(row["dpsi_deg"]))),
        error=ManeuverError(
            duration=float(row["error_duration_s"]),
            forward=float(row["error_dx_m"]),
            side=float(row["error_dy_m"]),
            heading_change=radians(float(row["error_dpsi_deg"])),
        ),
        notes=KINEMATIC_NOTES.get(number, ""),
    )


def _gtmax_trim(row: Row) -> Trim:
    return Trim(
        id=int(row["trim"]),
        name=row["description"],
        velocity=Twist(
            _metres(row["u_fwd_ft_per_s"]), _metres(row["u_side_ft_per_s"]), float(row["yaw_rate_rad_per_s"])
        ),
        error=Twist(
            _metres(row["error_u_fwd_ft_per_s"]),
            _metres(row["error_u_side_ft_per_s"]),
            float(row["error_yaw_rate_rad_per_s"]),
        ),
    )


def _gtmax_maneuver(row: Row) -> Maneuver:
    number = int(row["maneuver"])
    return Maneuver(
        id=number,
        from_trim=int(row["from"]),
        to_trim=int(row["to"]),
        duration=float(row["duration_s"]),
        displacement=SE2(_metres(row["dx_ft"]), _metres(row["dy_ft"]), float(row["dpsi_rad"])),
        error=ManeuverError(
            duration=float(row["error_duration_s"]),
            forward=_metres(row["error_dx_ft"]),
            side=_metres(row["error_dy_ft"]),
            heading_change=float(row["error_dpsi_rad"]),
        ),
        notes=GTMAX_NOTES.get(number, ""),
    )


def _metres(feet: str) -> float:
    return float(Decimal(feet) * METRES_PER_FOOT)


def _rows(name: str) -> Iterator[Row]:
    with (TABLES / name).open(encoding="utf-8", newline="") as file:
        yield from csv.DictReader(file)


def _provenance(tables: str, *files: str) -> dict[str, object]:
    return {
        "source": f"thesis, {tables}, as printed",
        "made_by": "python -m tools.thesis_libraries",
        "facts": {name: hashlib.sha256((TABLES / name).read_bytes()).hexdigest() for name in files},
    }
