"""Rules for docstrings, help texts and public names."""

import ast
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

from tests.support.packages import ROOT, SHIPPED, UNSHIPPED

OPENINGS = re.compile(
    r"(what|which|how|that|of what|where|when|whether|whose|who|why|if)\b", flags=re.IGNORECASE
)
MOST_WORDS = 12
MOST_WORDS_OF_AN_OPTION = 16

# Words of a language of this project's own, nowhere part of a public name. Singular, without "-s".
DIALECT = frozenset(
    (
        *("told", "bearable", "lend", "answered", "promise", "promised", "dear", "asked"),
        *("blame", "sheaf", "fan", "forest", "refuse", "refuter", "soonest", "nearest", "grown", "hope"),
        *("spread", "foreign", "activation", "fallback", "keeping", "survey", "departure", "spoke"),
        *("remainder", "wanted", "bent", "foretell", "foretold", "believe", "believed", "refutation"),
    )
)
# Names, and classes, that say something else in this project than in the field, or nothing.
DIALECT_NAMES = frozenset(
    (
        *("way", "ways", "look", "means", "shown", "ring", "rings", "legs", "tail", "calibrated", "claims"),
        *("publish", "verdict", "left_out", "way_made", "way_to_rest", "ways_to_rest", "tube_card"),
        *("promise_card", "walk_numbers", "steady_levels", "messages_told", "stretches_flown", "worth"),
        *("lend_means", "bearable_to", "take", "keep", "lay", "whole", "bar", "foretells"),
    )
)
DIALECT_CLASSES = frozenset(
    (
        *("Told", "Levels", "Means", "Way", "Look", "Numbers", "Each", "Seen", "Wanted", "Memory", "Verdict"),
        *("Figure", "Flown", "Drawn", "Remainder", "Step", "Found", "Done", "Disk", "Row", "Active"),
    )
)
# In help texts, which have no other sense of these words.
DIALECT_IN_HELP = re.compile(
    r"\b(told|soonest|bearable|promis\w*|believ\w*|foret\w*|activations?|grown|blame\w*|lend|"
    r"all chance|to rest|keeps? its word|honest|given up|gives up)\b",
    flags=re.IGNORECASE,
)

Named = ast.ClassDef | ast.FunctionDef


def sources() -> Iterator[tuple[str, ast.Module]]:
    """Yields path and syntax tree of every module."""
    for package in (*SHIPPED, *UNSHIPPED):
        for path in sorted((ROOT / package).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def docstrings(place: str, module: ast.Module) -> Iterator[tuple[str, str]]:
    """Yields place and first paragraph of each docstring of a module."""
    for node in ast.walk(module):
        if isinstance(node, (ast.Module, Named)) and (text := ast.get_docstring(node)):
            yield f"{place}:{getattr(node, 'lineno', 1)}", first_paragraph(text)


def value_docstrings(place: str, module: ast.Module) -> Iterator[tuple[str, str]]:
    """Yields place and first paragraph of each text below a constant or attribute."""
    for node in ast.walk(module):
        if not isinstance(node, (ast.Module, ast.ClassDef)):
            continue
        for before, after in pairwise(node.body):
            if isinstance(before, (ast.Assign, ast.AnnAssign)) and isinstance(after, ast.Expr):
                value = after.value
                if isinstance(value, ast.Constant) and isinstance(value.value, str):
                    yield f"{place}:{after.lineno}", first_paragraph(value.value)


def first_paragraph(text: str) -> str:
    """Returns the first paragraph of a text in one line."""
    return " ".join(text.split("\n\n", maxsplit=1)[0].split())


def count_words(sentence: str) -> int:
    """Returns the number of words; code in backquotes is one word."""
    return len(re.sub(r"`[^`]*`", "x", sentence).split())


def sentence_faults(sentence: str, most: int) -> list[str]:
    """Returns the faults of a first sentence: its opening, its length."""
    faults = []
    if OPENINGS.match(sentence):
        faults.append(f"begins with {sentence.split(maxsplit=1)[0]!r}")
    if count_words(sentence) > most:
        faults.append(f"has {count_words(sentence)} words, expected at most {most}")
    return faults


def help_faults(text: str, most: int) -> list[str]:
    """Returns the faults of a help text: opening, length, dialect."""
    clause = re.split(r"[;:(]|\.(?:\s|$)", first_paragraph(text))[0]
    faults = sentence_faults(clause, most) if clause else ["is empty"]
    return faults + [f"says {word!r}" for word in DIALECT_IN_HELP.findall(" ".join(text.split()))]


def name_faults(place: str, module: ast.Module) -> list[str]:
    """Returns the dialect among a module's public names and its own."""
    nodes = [node for node in module.body if isinstance(node, Named) and node.name[0] != "_"]
    names = [Path(place).stem, *(node.name for node in nodes if not node.name.startswith("test_"))]
    return [f"{place}: {name}" for name in names if is_dialect(name)]


def is_dialect(name: str) -> bool:
    """Returns True if a name or a part of it is dialect."""
    parts = {part.lower() for part in re.findall(r"[A-Z]?[a-z]+", name)}
    parts |= {part.removesuffix("s") for part in parts}
    return bool(parts & DIALECT) or name in DIALECT_NAMES or name in DIALECT_CLASSES
