"""Kinds of files that can be imported, by their first bytes."""

from pathlib import Path
from typing import Literal

from flight.errors import BadFileError

Kind = Literal["ULog", "MCAP", "table", "DataFlash log", "ROS 1 bag", "ROS 2 bag"]

_MAGIC: tuple[tuple[bytes, Kind], ...] = (
    (b"ULog\x01\x12\x35", "ULog"),
    (b"\x89MCAP0\r\n", "MCAP"),
    (b"\x28\xb5\x2f\xfd", "MCAP"),
    (b"\xa3\x95", "DataFlash log"),
    (b"#ROSBAG V2.0", "ROS 1 bag"),
    (b"SQLite format 3\x00", "ROS 2 bag"),
)
_SUFFIXES: dict[str, Kind] = {
    **{".ulg": "ULog", ".ulog": "ULog", ".mcap": "MCAP", ".zstd": "MCAP", ".zst": "MCAP"},
    **{".bin": "DataFlash log", ".bag": "ROS 1 bag", ".db3": "ROS 2 bag"},
}
_TABLES = frozenset({".csv", ".tsv", ".txt", ".dat", ".tab"})
_POINTER = b"version https://git-lfs"
_METADATA = "metadata.yaml"


def kind_of(path: Path) -> Kind:
    """Returns the kind of a file or bag folder.

    Raises:
        BadFileError: it cannot be read, or is no such file.
    """
    if path.is_dir():
        if (path / _METADATA).is_file():
            return "ROS 2 bag"
        raise BadFileError(
            path, f"expected a log, or a folder with {_METADATA}, a ROS 2 bag; got another folder"
        )
    try:
        with path.open("rb") as stream:
            head = stream.read(64)
    except FileNotFoundError:
        # Its name tells which options it has; its reader says that it does not exist.
        head = b""
    except OSError as error:
        raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None
    if head.startswith(_POINTER):
        raise BadFileError(path, "is a pointer of Git LFS, not the file: run git lfs pull")
    for magic, kind in _MAGIC:
        if head.startswith(magic):
            return kind
    suffix = path.suffix.lower()
    if suffix in _SUFFIXES:
        return _SUFFIXES[suffix]
    if suffix in _TABLES:
        return "table"
    raise BadFileError(
        path,
        "expected a ULog (.ulg), an MCAP (.mcap, .mcap.zstd), a table (.csv, .tsv, .txt), a DataFlash log "
        "(.bin), a ROS bag (.bag, .db3, a folder), got something else",
    )


def importable(folder: Path) -> list[Path]:
    """Returns the logs in a folder, bags in folders included, in order."""
    found = []
    for path in sorted(folder.iterdir()):
        if (path.is_dir() and (path / _METADATA).is_file()) or (
            path.is_file() and path.suffix.lower() in {*_SUFFIXES, *_TABLES}
        ):
            found.append(path)
    return found
