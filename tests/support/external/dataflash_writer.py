"""DataFlash log of ArduPilot of the circle, written from its specification."""

import struct

import numpy as np

from .flown_circle import HEIGHT, RADIUS, RATE, SPEED

TIME = 0.04 * np.arange(500)
_HEAD = b"\xa3\x95"
_FORMATS = (
    (128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
    (130, "XKF1", "QBffffff", "TimeUS,C,VN,VE,VD,PN,PE,PD"),
    (131, "ATT", "Qfff", "TimeUS,Roll,Pitch,Yaw"),
    (132, "RCOU", "QHHH", "TimeUS,C1,C2,C3"),
)
_SIZES = {"B": 1, "n": 4, "N": 16, "Z": 64, "Q": 8, "f": 4, "H": 2}


def dataflash() -> bytes:
    """Returns a log of positions, attitudes in degrees and servo outputs."""
    parts = []
    for number, name, letters, columns in _FORMATS:
        length = 3 + sum(_SIZES[letter] for letter in letters)
        body = struct.pack("<BB4s16s64s", number, length, name.encode(), letters.encode(), columns.encode())
        parts.append(_HEAD + bytes([128]) + body)
    for time in TIME.tolist():
        stamp, turned = round(1e6 * (time + 3.0)), RATE * time
        motion = (SPEED * np.cos(turned), SPEED * np.sin(turned), 0.0)
        place = (RADIUS * np.sin(turned), RADIUS * (1.0 - np.cos(turned)), -HEIGHT)
        parts.append(_HEAD + bytes([130]) + struct.pack("<QB6f", stamp, 0, *motion, *place))
        parts.append(_HEAD + bytes([131]) + struct.pack("<Q3f", stamp, 0.0, 0.0, np.degrees(turned) % 360.0))
        parts.append(_HEAD + bytes([132]) + struct.pack("<Q3H", stamp, 1500, 1000 + int(10 * time), 0))
    return b"".join(parts)
