"""Number types of options: whole counts, never rounded; positive times."""

from collections.abc import Sequence
from math import inf
from typing import Annotated

from cyclopts import Parameter, Token
from cyclopts.validators import Number


def _parse_whole_number(_: type, tokens: Sequence[Token]) -> int:
    (token,) = tokens
    try:
        return int(token.value)
    except ValueError:
        raise ValueError(f"expected a whole number, got {token.value!r}") from None


Count = Annotated[int, Parameter(converter=_parse_whole_number, validator=Number(gte=1, lte=1_000_000))]
"""Whole number, at least one."""

Seed = Annotated[int, Parameter(converter=_parse_whole_number, validator=Number(gte=0, lt=2**63))]
"""Seed of random numbers."""


def _parse_positive_number(_: type, tokens: Sequence[Token]) -> float:
    (token,) = tokens
    try:
        value = float(token.value)
    except ValueError:
        value = 0.0
    if not 0 < value < inf:
        raise ValueError(f"expected seconds above 0, got {token.value!r}")
    return value


Seconds = Annotated[float, Parameter(converter=_parse_positive_number)]
"""Time in seconds, above 0."""
