"""Tests of the language of docstrings and public names."""

import ast
from collections import Counter

import pytest

from tests.support.packages import SHIPPED

from .text_rules import (
    MOST_WORDS,
    OPENINGS,
    Named,
    count_words,
    docstrings,
    is_dialect,
    name_faults,
    sentence_faults,
    sources,
    value_docstrings,
)

MODULES = tuple(sources())
SENTENCES = [pair for place, module in MODULES for pair in docstrings(place, module)]


def test_docstrings_begin_with_a_noun_or_a_verb() -> None:
    assert len(SENTENCES) > 2500
    assert not [f"{place}: {text}" for place, text in SENTENCES if OPENINGS.match(text)]


def test_texts_of_constants_begin_with_a_noun() -> None:
    texts = [pair for place, module in MODULES for pair in value_docstrings(place, module)]
    assert len(texts) > 500
    assert not [f"{place}: {text}" for place, text in texts if OPENINGS.match(text)]


def test_a_riddle_below_a_constant_is_found() -> None:
    module = ast.parse('TIME = 1.0\n"""What a plan takes."""\n')
    assert [text for _, text in value_docstrings("flight.py", module)] == ["What a plan takes."]
    assert OPENINGS.match("What a plan takes.")


def test_first_sentences_of_the_product_are_short() -> None:
    product = [(place, text) for place, text in SENTENCES if place.split("/")[0] in SHIPPED]
    assert len(product) > 1000
    assert not [f"{place}: {text}" for place, text in product if count_words(text) > MOST_WORDS]


@pytest.mark.parametrize(
    "sentence",
    [
        "What a log is of.",
        "how a flight went",
        "Whose errors these are.",
        "Returns the errors of " + "each and " * 6,
    ],
)
def test_a_riddle_among_the_docstrings_is_found(sentence: str) -> None:
    assert sentence_faults(sentence, MOST_WORDS)
    module = ast.parse(f'class Flight:\n    """{sentence}"""\n')
    assert [text for _, text in docstrings("flight.py", module)] == [sentence.strip()]


def test_a_plain_docstring_has_no_fault() -> None:
    assert not sentence_faults("Whatever-shaped trims, returned by `a long piece of code`.", MOST_WORDS)


def test_no_module_class_or_public_function_is_named_in_dialect() -> None:
    assert not [fault for place, module in MODULES for fault in name_faults(place, module)]


@pytest.mark.parametrize(
    ("place", "source"),
    [
        ("planner/forest.py", ""),
        ("planner/walks.py", "class Refuter:\n    pass\n"),
        ("planner/walks.py", "class Levels:\n    pass\n"),
        ("planner/walks.py", "def count_activations():\n    pass\n"),
        ("planner/walks.py", "def left_out():\n    pass\n"),
    ],
)
def test_a_name_in_dialect_is_found(place: str, source: str) -> None:
    assert len(name_faults(place, ast.parse(source))) == 1


@pytest.mark.parametrize("name", ["GammaEstimator", "RemainingPlan", "left_turn", "refuted_share", "Motion"])
def test_a_name_of_the_field_is_free(name: str) -> None:
    assert not is_dialect(name)


def test_every_class_of_the_product_has_a_name_of_its_own() -> None:
    names = Counter(
        node.name
        for place, module in MODULES
        for node in module.body
        if isinstance(node, ast.ClassDef) and place.split("/")[0] in SHIPPED and node.name[0] != "_"
    )
    assert not [name for name, count in names.items() if count > 1]
    assert issubclass(ast.ClassDef, Named)
