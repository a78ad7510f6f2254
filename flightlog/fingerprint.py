"""A flight's fingerprint: what was flown, without what cannot change it."""

import json
from dataclasses import asdict
from hashlib import sha256

from .log import FlightLog


def fingerprint(log: FlightLog) -> str:
    """Returns the SHA-256, in hexadecimal, of all that a log holds but for how it was computed.

    Machine code is used only where it gives the bits of the interpreter (`sim.loop.backend`), so that a
    flight has
    one fingerprint with a compiler and without; a change of code that changes no flight changes none either,
    nor does how the file is packed.
    """
    header = asdict(log.header)
    header |= {"backend": log.header.arithmetic, "code_version": log.header.release}
    digest = sha256(json.dumps(header, sort_keys=True).encode())
    for name, series in sorted(log.series.items()):
        digest.update(name.encode())
        digest.update(series.time.tobytes() + series.values.tobytes())
    for name, content in sorted(log.attachments.items()):
        digest.update(name.encode() + b"\0" + sha256(content).digest())
    return digest.hexdigest()
