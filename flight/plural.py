"""Numbers with their nouns."""


def plural(number: int, noun: str) -> str:
    """Returns `1 trim`, `2 trims`, `0 trims`; for nouns whose plural ends in s."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
