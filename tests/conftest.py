"""Options of the studies, and the browser's availability."""

import pytest

from tests.support.browser import CHROMIUM
from tests.support.studies.study import SIZES, Study


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds an option for each size of a study."""
    group = parser.getgroup("studies", "sizes of tests marked slow")
    for name, meaning in SIZES.items():
        group.addoption(f"--{name}", type=int, metavar="N", help=meaning)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skips a test that needs a browser where there is none."""
    if CHROMIUM is None and item.get_closest_marker("browser"):
        pytest.skip("no Chromium on this machine")


@pytest.fixture
def study(pytestconfig: pytest.Config, capsys: pytest.CaptureFixture[str]) -> Study:
    """Returns the sizes of a study, and prints its figures past the capture of output."""

    def show(line: str) -> None:
        with capsys.disabled():
            print(f"\n{line}", end="", flush=True)

    return Study(pytestconfig.getoption, show)
