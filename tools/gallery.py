"""Makes the pictures of docs/review.md, and two of the README: `python -m tools.gallery`; needs Chromium.

That of an imported log is made where the log is named: `python -m tools.gallery sample_px4_events.ulg`.
"""

import os
import shlex
import shutil
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from maneuver.app import run
from tests.support.browser import CHROMIUM, Tab, browser

DOCS = Path(__file__).parent.parent / "docs"

FLIGHTS = {
    "identification": "fly --campaign gtmax --flights 6 --out flights",
    "worst-case": "fly --mission gtmax-2 --seed 1 --out worst-case.mcap",
    "nominal": "fly --mission gtmax-2 --seed 1 --policy nominal --out nominal.mcap",
    "fault": 'fly --sequence figure-eight --fault "gps dropout 20 15" --out fault.mcap',
}
"""What is flown for the gallery, as typed after `maneuver`."""

DRAWN = {
    "fly --sequence figure-eight --out eight.mcap": None,
    "review eight.mcap --png --out eight-review": "eight-review/flight.png",
    "review worst-case.mcap --still chase.png --at 9.6": "chase.png",
}
"""Pictures of the README, by what draws them; None where that draws none."""

IMPORT = "import sample_px4_events.ulg"
IMPORTED = "sample_px4_events.mcap"


@dataclass(frozen=True, slots=True)
class _Shot:
    """A picture of a page.

    Attributes:
        picture: its file in docs/.
        review: what is typed after `maneuver review`.
        page: file that it writes, in the folder `pages`.
        steps: expressions run before the picture is taken.
        dark: colour scheme.
        phone: whether it is seen on a phone.
        height: of the window, CSS pixels.
    """

    picture: str
    review: str
    page: str
    steps: tuple[str, ...] = ()
    dark: bool = False
    phone: bool = False
    height: int = 1000


_TO_PLOTS = "document.getElementById('lane-frame').scrollIntoView({behavior: 'instant'})"
_CHOOSE_WORST = (
    "choose(0, flights[0].primitives.map((part, i) => [part.judged ? part.judged.share : 0, i])"
    ".sort((a, b) => b[0] - a[0])[0][1])"
)
_TO_NAVIGATION = (
    "document.getElementById('navigation').scrollIntoView({behavior: 'instant'}); scrollBy(0, -120)"
)

SHOTS = (
    _Shot("review-worst-case.png", "worst-case.mcap", "worst-case.html"),
    _Shot("review-plots.png", "worst-case.mcap", "worst-case.html", (_CHOOSE_WORST, _TO_PLOTS), height=820),
    _Shot("review-phone.png", "worst-case.mcap", "worst-case.html", ("setView(true)",), phone=True),
    _Shot(
        "review-identification.png",
        "flights/gtmax-0000.mcap --library gtmax-sim",
        "gtmax-0000.html",
        dark=True,
    ),
    _Shot("review-fault.png", "fault.mcap", "fault.html", (_TO_NAVIGATION,), height=820),
    _Shot("review-compare.png", "nominal.mcap worst-case.mcap", "nominal-and-worst-case.html"),
    _Shot("review-imported.png", IMPORTED, "sample_px4_events.html", (_TO_PLOTS,), height=820),
    _Shot("review-campaign.png", "flights --pages 3 --library gtmax-sim", "index.html", height=560),
)


def main() -> int:
    """Flies, reviews, and takes the pictures; returns the exit code."""
    if CHROMIUM is None:
        print("no Chromium on this machine: there is nothing to take pictures with", file=sys.stderr)
        return 2
    with TemporaryDirectory() as name:
        folder = Path(name)
        for line in FLIGHTS.values():
            _run_command(line, folder)
        shots = [shot for shot in SHOTS if shot.review != IMPORTED or len(sys.argv) > 1]
        if len(sys.argv) > 1:
            shutil.copy(sys.argv[1], folder / "sample_px4_events.ulg")
            _run_command(IMPORT, folder)
        for review in dict.fromkeys(shot.review for shot in shots):
            _run_command(f"review {review} --html --force --out pages", folder)
        for line, picture in DRAWN.items():
            _run_command(line, folder)
            if picture is not None:
                shutil.copy(folder / picture, DOCS)
        with browser(folder / "profile") as tab:
            for shot in shots:
                _take(tab, shot, folder / "pages" / shot.page)
    return 0


def _run_command(line: str, folder: Path) -> None:
    """Runs one command with its file names in a folder."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        code = run(shlex.split(line))
    finally:
        os.chdir(before)
    assert code in {0, 1}, (line, code)


def _take(tab: Tab, shot: _Shot, page: Path) -> None:
    width, height = (390, 844) if shot.phone else (1440, shot.height)
    tab.resize(width, height, dark=shot.dark, phone=shot.phone)
    tab.open(page)
    for step in shot.steps:
        tab.run(step)
        tab.settle()
    for _ in range(3):
        tab.settle()
    tab.picture(DOCS / shot.picture)
    assert tab.complaints == [], tab.complaints


def commands() -> Sequence[str]:
    """Returns every command of the gallery, as typed."""
    reviews = dict.fromkeys(f"review {shot.review} --html" for shot in SHOTS)
    return [f"maneuver {line}" for line in (*FLIGHTS.values(), IMPORT, *reviews)]


if __name__ == "__main__":
    sys.exit(main())
