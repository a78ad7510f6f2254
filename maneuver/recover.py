"""`maneuver recover`: the intact part of a damaged log."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from flight.errors import BadFileError, FlightError
from flightlog.file.reader import MAGIC
from flightlog.file.recovery import Salvage, contains_salvage, recovered_bytes, salvage
from flightlog.file.writer import LARGEST_LOG
from runtime.atomic_write import check_output_files, write_atomically

NOTHING_TO_SAVE = 1
WITH_LOSS = 3


def recover(
    log: Annotated[Path, Parameter(negative="")],
    /,
    *,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Recovers the intact part of a truncated or damaged MCAP file.

    Every chunk and attachment with a correct checksum is kept, and the result is verified by reading it
    again. The exit code is 0 without loss, 3 with loss, 1 if nothing could be recovered. The outcome of a
    flight log recovered with loss states the loss, and identification counts the flight as lost.

    For example:

        maneuver recover flights/gtmax-0007.mcap --out gtmax-0007-recovered.mcap

    Args:
        log: damaged file; it is not changed.
        out: recovered log; beside LOG, with `-recovered` in its name, by default.
        force: overwrite OUT.
    """
    out = out or log.with_name(f"{log.stem}-recovered.mcap")
    check_output_files(out, force=force, inputs=[log])
    damaged = _content(log)
    found = salvage(damaged)
    if not found.messages:
        what = "no intact chunk of messages" if damaged.startswith(MAGIC) else "no start of an MCAP file"
        print(f"nothing to recover: {log} has {what} in its {len(damaged)} bytes")
        return NOTHING_TO_SAVE
    content = recovered_bytes(found)
    if not contains_salvage(content, found):
        raise FlightError(f"{log}: the recovered part cannot be read again; nothing was written")
    write_atomically(content, out, force=force)
    print(f"recovered  {out}")
    print(
        f"kept       {len(found.messages)} messages of {len(found.channels)} channels, "
        f"{len(found.attachments)} attachments, up to {found.last_time:.2f} s"
    )
    print(f"lost       {_losses(found)}")
    return 0 if found.lossless else WITH_LOSS


def _content(path: Path) -> bytes:
    try:
        size = path.stat().st_size
        if size > LARGEST_LOG:
            raise BadFileError(path, f"expected at most {LARGEST_LOG} bytes, got {size}")
        return path.read_bytes()
    except OSError as error:
        raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None


def _losses(found: Salvage) -> str:
    if found.lossless:
        return "nothing"
    counts = {
        "damaged chunks": found.damaged_chunks,
        "damaged attachments": found.damaged_attachments,
        "messages of unknown channels": found.orphans,
        "bytes outside records": found.skipped_bytes,
    }
    parts = [f"{count} {what}" for what, count in counts.items() if count]
    if found.announced is not None and found.announced > len(found.messages):
        parts.append(f"{found.announced - len(found.messages)} of {found.announced} messages")
    elif not found.ended:
        parts.append("everything after the end of the truncated file")
    if found.data_intact is False and not parts:
        parts.append("no message, but other bytes were altered")
    return ", ".join(parts)
