"""Whole numbers on the command line: taken as they are, never rounded."""

from collections.abc import Sequence
from typing import Annotated

from cyclopts import Parameter, Token
from cyclopts.validators import Number


def _whole(_: type, tokens: Sequence[Token]) -> int:
    (token,) = tokens
    try:
        return int(token.value)
    except ValueError:
        raise ValueError(f"expected a whole number, got {token.value!r}") from None


Count = Annotated[int, Parameter(converter=_whole, validator=Number(gte=1, lte=1_000_000))]
"""A number of things: at least one."""

Seed = Annotated[int, Parameter(converter=_whole, validator=Number(gte=0, lt=2**63))]
"""Of all chance."""
