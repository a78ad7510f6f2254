"""The shape that a log carries, as MJCF that somebody else may have written: read only if it can do no harm.

MJCF can name other files, make copies of bodies by the million and load plug-ins. A shape needs none of that:
what is no part of one is refused before any reader sees it.
"""

from math import isfinite
from xml.etree import ElementTree

from flight.errors import BadFileError

LARGEST_MODEL = 256 * 1024
"""Bytes; the shipped shape has four thousand."""

MOST_PARTS = 2000
"""Elements; more cannot be told apart on a screen."""

_LARGEST_TEXTURE = 4096
_ELEMENTS = {
    *("mujoco", "compiler", "option", "flag", "statistic", "visual", "global", "headlight", "map", "default"),
    *("asset", "material", "texture", "worldbody", "body", "geom", "site", "inertial", "freejoint"),
    *("camera", "light"),
}
# Folders in which files are sought; what names a file has that word in its name.
_FOLDERS = {"meshdir", "texturedir", "assetdir"}


def parse_model(text: bytes, source: str) -> ElementTree.Element:
    """Returns the root of a shape that names no file, no entity and nothing but finite numbers.

    Raises:
        BadFileError: it is too large, is no XML, or has something in it that no shape needs; says what.
    """
    if len(text) > LARGEST_MODEL:
        raise BadFileError(source, f"expected at most {LARGEST_MODEL} bytes, got {len(text)}")
    try:
        # As text, so that no other encoding hides what is looked for.
        words = text.decode("utf-8")
        if "<!DOCTYPE" in words or "<!ENTITY" in words:
            raise BadFileError(source, "has a document type: expected no entities")
        root = ElementTree.fromstring(words)
    except (ElementTree.ParseError, ValueError) as error:
        raise BadFileError(source, f"is no model that can be drawn: {error}") from None
    parts = list(root.iter())
    if len(parts) > MOST_PARTS:
        raise BadFileError(source, f"expected at most {MOST_PARTS} parts, got {len(parts)}")
    for part in parts:
        _check_element(part, source)
    return root


def _check_element(part: ElementTree.Element, source: str) -> None:
    if part.tag not in _ELEMENTS:
        raise BadFileError(source, f"has <{part.tag:.40}>: expected one of {sorted(_ELEMENTS)}")
    for name, value in part.attrib.items():
        if "file" in name or name in _FOLDERS:
            raise BadFileError(source, f"names a file, {name}={value!r:.60}: expected all in one text")
        for word in value.split():
            if not _is_finite_or_word(word):
                raise BadFileError(source, f"{part.tag} {name}: expected finite numbers, got {word!r:.40}")
    if part.tag == "texture":
        for name in ("width", "height"):
            if not part.get(name, "0").isdecimal() or int(part.get(name, "0")) > _LARGEST_TEXTURE:
                raise BadFileError(source, f"texture {name}: expected at most {_LARGEST_TEXTURE}")


def _is_finite_or_word(word: str) -> bool:
    try:
        return isfinite(float(word))
    except ValueError:
        # A name or a choice of words.
        return True
