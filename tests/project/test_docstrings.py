"""Tests of the language of docstrings and help texts: openings, lengths, names."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from maneuver.app import VERBS
from tests.support.packages import SHIPPED, UNSHIPPED

ROOT = Path(__file__).parents[2]
OPENINGS = re.compile(r"(What|Which|How|That|Of what|Where|When|Whether|Whose|Who|Why|If)\b")
MOST_WORDS = 12

# Words that were a language of this project's own; see CONTRIBUTING for the field's.
DIALECT = {
    *("told", "soonest", "bearable", "promise", "promised", "grown", "blame", "lend", "means", "refuter"),
    *("forest", "sheaf", "keeping", "answered", "foreign", "activation", "verdicts", "departure"),
}

Named = ast.ClassDef | ast.FunctionDef


def sources() -> Iterator[tuple[str, ast.Module]]:
    for package in (*SHIPPED, *UNSHIPPED):
        for path in sorted((ROOT / package).rglob("*.py")):
            yield path.relative_to(ROOT).as_posix(), ast.parse(path.read_text(encoding="utf-8"))


def docstrings() -> Iterator[tuple[str, str]]:
    """Yields the place and the first sentence of every docstring."""
    for place, module in sources():
        for node in ast.walk(module):
            if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)) and ast.get_docstring(node):
                text = (ast.get_docstring(node) or "").split("\n\n")[0]
                yield f"{place}:{getattr(node, 'lineno', 1)}", " ".join(text.split())


def words(sentence: str) -> int:
    return len(re.sub(r"`[^`]*`", "x", sentence).split())


def test_docstrings_begin_with_a_noun_or_a_verb() -> None:
    assert not [f"{place}: {text}" for place, text in docstrings() if OPENINGS.match(text)]


def test_first_sentences_of_the_product_are_short() -> None:
    product = [(place, text) for place, text in docstrings() if not place.startswith("tests/")]
    assert len(product) > 1000
    assert not [f"{place}: {text}" for place, text in product if words(text) > MOST_WORDS]


@pytest.mark.parametrize("name", VERBS)
def test_help_of_verbs_is_one_short_sentence(name: str) -> None:
    _, text = VERBS[name]
    assert not OPENINGS.match(text)
    assert words(text) <= MOST_WORDS


def test_no_module_class_or_public_function_is_named_in_dialect() -> None:
    found = []
    for place, module in sources():
        names = [Path(place).stem]
        names += [node.name for node in module.body if isinstance(node, Named) and node.name[0] != "_"]
        for name in names:
            parts = re.findall(r"[A-Z]?[a-z]+", name)
            if not name.startswith("test_") and {part.lower() for part in parts} & DIALECT:
                found.append(f"{place}: {name}")
    assert not found
