"""Check of an attached MJCF shape from an untrusted source.

MJCF can include files, replicate bodies by the million and load plug-ins. A shape needs none of these; they
are refused before any MJCF reader is called.
"""

from math import isfinite
from xml.etree import ElementTree

from flight.errors import BadFileError

LARGEST_MODEL = 256 * 1024
"""Largest shape in bytes; the shipped one has four thousand."""

MOST_PARTS = 2000
"""Largest number of elements."""

_LARGEST_TEXTURE = 4096
_ELEMENTS = {
    *("mujoco", "compiler", "option", "flag", "statistic", "visual", "global", "headlight", "map", "default"),
    *("asset", "material", "texture", "worldbody", "body", "geom", "site", "inertial", "freejoint"),
    *("camera", "light"),
}
# Attributes that name folders; those that name a file contain `file`.
_FOLDERS = {"meshdir", "texturedir", "assetdir"}


def parse_model(text: bytes, source: str) -> ElementTree.Element:
    """Returns the root of a shape without files, entities or non-finite numbers.

    Raises:
        BadFileError: it is too large, not XML, or has elements that no shape needs.
    """
    if len(text) > LARGEST_MODEL:
        raise BadFileError(source, f"expected at most {LARGEST_MODEL} bytes, got {len(text)}")
    try:
        # Decoded first, so that no other encoding hides an entity.
        words = text.decode("utf-8")
        if "<!DOCTYPE" in words or "<!ENTITY" in words:
            raise BadFileError(source, "expected no document type, got one")
        root = ElementTree.fromstring(words)
    except (ElementTree.ParseError, ValueError) as error:
        raise BadFileError(source, f"expected a drawable model: {error}") from None
    parts = list(root.iter())
    if len(parts) > MOST_PARTS:
        raise BadFileError(source, f"expected at most {MOST_PARTS} parts, got {len(parts)}")
    for part in parts:
        _check_element(part, source)
    return root


def _check_element(part: ElementTree.Element, source: str) -> None:
    if part.tag not in _ELEMENTS:
        raise BadFileError(source, f"expected elements of {sorted(_ELEMENTS)}, got <{part.tag:.40}>")
    for name, value in part.attrib.items():
        if "file" in name or name in _FOLDERS:
            raise BadFileError(source, f"expected no names of files, got {name}={value!r:.60}")
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
