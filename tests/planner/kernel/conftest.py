"""Options of the planning proof: how many missions, from which seed."""

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds `--missions` and `--seed`."""
    parser.addoption("--missions", type=int, default=2000, help="missions of the planning proof")
    parser.addoption("--seed", type=int, default=1, help="seed of the planning proof")
