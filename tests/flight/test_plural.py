"""Numbers with their nouns."""

from flight.plural import plural


def test_one_is_singular_and_all_others_are_plural() -> None:
    assert [plural(number, "time-out") for number in (0, 1, 2)] == [
        "0 time-outs",
        "1 time-out",
        "2 time-outs",
    ]
