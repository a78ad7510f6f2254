"""Recovery of the intact messages of a damaged PX4 ULog.

A ULog has no checksums. A message counts as intact if its kind is known and, for data, if its topic is
announced and has that size. After damage the search resumes where several such messages follow one another.
Changes inside a message are not detected.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

MAGIC = b"ULog\x01\x12\x35"
HEADER = 16
"""Bytes before the first message."""

_HEAD = struct.Struct("<HB")
_ID = struct.Struct("<H")
_TIME = struct.Struct("<HQ")
_STAMP = struct.Struct("<Q")
_SIZES = {
    **{f"{sign}int{bits}_t": bits // 8 for sign in ("", "u") for bits in (8, 16, 32, 64)},
    **{"float": 4, "double": 8, "bool": 1, "char": 1},
}
# Formats may name other formats; damaged ones may name themselves.
_DEEPEST = 8
_KINDS = frozenset(b"BFIMPQARDLCSO")
_DATA, _ANNOUNCED, _FORMAT = ord("D"), ord("A"), ord("F")
# Consecutive messages required to resume after damage.
_MIN_CONSECUTIVE = 8
# Largest step of time between messages, microseconds.
_LATEST = 3_600_000_000


@dataclass(frozen=True, slots=True)
class IntactMessages:
    """Intact messages of a ULog, and the number of bytes lost."""

    content: bytes
    lost: int


@dataclass(slots=True)
class _ScanState:
    """State of the scan.

    Attributes:
        sizes: size of a message by topic.
        latest: latest time, microseconds.
        formats: fields by name of a format.
        names: format by topic.
        offsets: bytes before the time by topic.
    """

    sizes: dict[int, int] = field(default_factory=dict)
    latest: int = 0
    formats: dict[str, str] = field(default_factory=dict)
    names: dict[int, str] = field(default_factory=dict)
    offsets: dict[int, int] = field(default_factory=dict)

    def stamp(self, content: bytes, position: int, size: int) -> tuple[int, int]:
        """Returns the topic and the time of a message of data."""
        (number,) = _ID.unpack_from(content, position)
        if number not in self.offsets:
            self.offsets[number] = self._offset(self.formats.get(self.names.get(number, ""), ""), 0)
        place = _ID.size + self.offsets[number]
        if place + _STAMP.size > size:
            return number, self.latest
        (time,) = _STAMP.unpack_from(content, position + place)
        return number, time

    def _offset(self, fields: str, depth: int) -> int:
        """Returns the bytes before the field `timestamp`; 0 without one."""
        passed = 0
        for each in filter(None, fields.split(";")):
            kind, _, name = each.strip().partition(" ")
            if name == "timestamp":
                return passed
            passed += self._size(kind, depth)
        return 0

    def _size(self, kind: str, depth: int) -> int:
        base, _, count = kind.partition("[")
        number = int(count[:-1]) if count[:-1].isdigit() else 1
        if base in _SIZES or depth > _DEEPEST:
            return _SIZES.get(base, 0) * number
        parts = (
            each.strip().partition(" ")[0] for each in self.formats.get(base, "").split(";") if each.strip()
        )
        return number * sum(self._size(part, depth + 1) for part in parts)


def intact_messages(content: bytes) -> IntactMessages:
    """Returns the intact messages of a ULog's bytes."""
    known, parts = _ScanState(), [content[:HEADER]]
    position = begun = HEADER
    while position < len(content):
        end = _message_end(content, position, known)
        if end:
            _update_scan_state(content, position, end, known)
            position = end
            continue
        parts.append(content[begun:position])
        position = begun = _find_next_intact(content, position + 1, known)
    parts.append(content[begun:position])
    kept = b"".join(parts)
    return IntactMessages(kept, len(content) - len(kept))


def _message_end(content: bytes, position: int, known: _ScanState) -> int:
    """Returns the end of a message at a position; 0 if none."""
    if position + _HEAD.size > len(content):
        return 0
    size, kind = _HEAD.unpack_from(content, position)
    end: int = position + _HEAD.size + size
    if end > len(content) or kind not in _KINDS:
        return 0
    # A format is text; one that spans damaged bytes is not.
    if kind == _FORMAT and not content[position + _HEAD.size : end].isascii():
        return 0
    if kind == _DATA:
        if size < _TIME.size:
            return 0
        number, time = known.stamp(content, position + _HEAD.size, size)
        if known.sizes.get(number) not in {0, size} or (known.latest and time > known.latest + _LATEST):
            return 0
    return end


def _update_scan_state(content: bytes, position: int, end: int, known: _ScanState) -> None:
    size, kind = _HEAD.unpack_from(content, position)
    if kind == _DATA:
        number, time = known.stamp(content, position + _HEAD.size, size)
        known.sizes[number] = size
        known.latest = max(known.latest, time)
    elif kind == _FORMAT:
        name, _, fields = content[position + _HEAD.size : end].decode("ascii").partition(":")
        known.formats[name] = fields
    elif kind == _ANNOUNCED and size > 3:
        # The first byte is the instance of the topic.
        (number,) = _ID.unpack_from(content, position + _HEAD.size + 1)
        known.sizes.setdefault(number, 0)
        known.names[number] = content[position + _HEAD.size + 3 : end].decode("ascii", "replace")


def _find_next_intact(content: bytes, position: int, known: _ScanState) -> int:
    """Returns the next position followed by several intact messages."""
    while position < len(content):
        ends = list(_consecutive_ends(content, position, known))
        if len(ends) == _MIN_CONSECUTIVE or (ends and ends[-1] == len(content)):
            return position
        position += 1
    return len(content)


def _consecutive_ends(content: bytes, position: int, known: _ScanState) -> Iterator[int]:
    for _ in range(_MIN_CONSECUTIVE):
        position = _message_end(content, position, known)
        if not position:
            return
        yield position
        if position == len(content):
            return
