"""Tests of the language of help texts: every verb, every option."""

from collections.abc import Iterator
from functools import cache

import pytest
from cyclopts import App

from maneuver.app import VERBS, build

from .text_rules import MOST_WORDS, MOST_WORDS_OF_AN_OPTION, help_faults


def verbs_of(app: App, path: tuple[str, ...] = ()) -> Iterator[tuple[str, App]]:
    """Yields name and application of each verb that has options."""
    if app.default_command is not None:
        yield " ".join(path), app
    for name in app:
        if not name.startswith("-"):
            yield from verbs_of(app[name], (*path, name))


@cache
def applications() -> dict[str, App]:
    """Returns the verbs by name."""
    return dict(verbs_of(build()))


def options_of(verb: App) -> dict[str, str]:
    """Returns the help of each option of a verb."""
    arguments = verb.assemble_argument_collection(parse_docstring=True)
    return {argument.name: argument.parameter.help or "" for argument in arguments if argument.show}


def faults_of(name: str, verb: App) -> list[str]:
    """Returns the faults in the help texts of a verb."""
    texts = {"": (verb.help.split("Args:")[0], MOST_WORDS)}
    texts |= {option: (text, MOST_WORDS_OF_AN_OPTION) for option, text in options_of(verb).items()}
    return [
        f"{name} {place}: {fault}"
        for place, (text, most) in texts.items()
        for fault in help_faults(text, most)
    ]


def test_every_verb_is_read() -> None:
    found = applications()
    assert {name.split()[0] for name in found} == set(VERBS)
    assert {"plan", "plan check", "plan signs", "library test", "library interpolate"} <= set(found)
    assert sum(len(options_of(verb)) for verb in found.values()) > 180


@pytest.mark.parametrize("name", VERBS)
def test_the_overview_has_one_short_sentence_for_each_verb(name: str) -> None:
    assert not help_faults(VERBS[name][1], MOST_WORDS)


def test_help_of_verbs_and_options_is_plain() -> None:
    assert not [fault for name, verb in applications().items() for fault in faults_of(name, verb)]


@pytest.mark.parametrize("words", ["who flies.", "seed of all chance.", "", "name of " + "a long " * 9])
def test_a_riddle_among_the_options_is_found(words: str) -> None:
    def verb(*, library: str) -> None:
        pass

    verb.__doc__ = f"Plans a mission.\n\nArgs:\n    library: {words}\n"
    app = App()
    app.default(verb)
    assert len(faults_of("plan", app)) == 1


@pytest.mark.parametrize("words", ["Whether a plan keeps its word.", "Says what it believes."])
def test_a_riddle_in_the_help_of_a_verb_is_found(words: str) -> None:
    def verb() -> None:
        pass

    verb.__doc__ = words
    app = App()
    app.default(verb)
    assert faults_of("plan", app)
