"""Maker of the pictures in docs and README: `python -m tools.gallery`.

That of an imported log is made where the log is named: `python -m tools.gallery sample_px4_events.ulg`.
`--check` writes nothing and exits with 1 where the page lacks a command or a picture.
"""

import argparse
import os
import re
import shlex
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from maneuver.app import run

from .screenshot import CHROMIUM, take_picture

DOCS = Path(__file__).parent.parent / "docs"
PAGE = DOCS / "review.md"

FLIGHTS = {
    "identification": "fly --campaign gtmax --flights 6 --out flights",
    "worst-case": "fly --mission gtmax-2 --seed 1 --out worst-case.mcap",
    "nominal": "fly --mission gtmax-2 --seed 1 --policy nominal --out nominal.mcap",
    "fault": 'fly --sequence figure-eight --fault "gps dropout 20 15" --out fault.mcap',
}
"""Commands of the flights in the gallery, as typed after `maneuver`."""

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
    """Makes the pictures, or checks the page; returns the exit code."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("ulog", nargs="?", type=Path, help="the imported log")
    parser.add_argument("--check", nargs="?", type=Path, const=PAGE, metavar="PAGE", help="docs/review.md")
    arguments = parser.parse_args()
    if arguments.check is not None:
        missing = _missing(arguments.check)
        for line in missing:
            print(f"{arguments.check.name} lacks {line}", file=sys.stderr)
        return 1 if missing else 0
    if CHROMIUM is None:
        print("no Chromium on this machine: there is nothing to take pictures with", file=sys.stderr)
        return 2
    with TemporaryDirectory() as name:
        _make(Path(name), arguments.ulog)
    return 0


def _make(folder: Path, ulog: Path | None) -> None:
    for line in FLIGHTS.values():
        _run_command(line, folder)
    if ulog is not None:
        shutil.copy(ulog, folder / "sample_px4_events.ulg")
        _run_command(IMPORT, folder)
    shots = [shot for shot in SHOTS if shot.review != IMPORTED or ulog is not None]
    for review in dict.fromkeys(shot.review for shot in shots):
        _run_command(f"review {review} --html --force --out pages", folder)
    for line, picture in DRAWN.items():
        _run_command(line, folder)
        if picture is not None:
            shutil.copy(folder / picture, DOCS)
    for shot in shots:
        take_picture(
            folder / "pages" / shot.page,
            DOCS / shot.picture,
            width=390 if shot.phone else 1440,
            height=844 if shot.phone else shot.height,
            steps=shot.steps,
            dark=shot.dark,
            scale=2 if shot.phone else 1,
        )


def _run_command(line: str, folder: Path) -> None:
    """Runs one command with its file names in a folder."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        code = run(shlex.split(line))
    finally:
        os.chdir(before)
    assert code in {0, 1}, (line, code)


def _missing(page: Path) -> list[str]:
    """Returns commands and pictures that a page lacks."""
    text = page.read_text(encoding="utf-8")
    shown = {line[2:] for line in text.splitlines() if line.startswith("$ ")}
    reviews = dict.fromkeys(f"review {shot.review} --html" for shot in SHOTS)
    commands = [f"maneuver {line}" for line in (*FLIGHTS.values(), IMPORT, *reviews)]
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    return [
        *(f"the command `{command}`" for command in commands if command not in shown),
        *(f"the picture {shot.picture}" for shot in SHOTS if shot.picture not in pictures),
        *(f"the file of {picture}" for picture in pictures if not (DOCS / picture).is_file()),
    ]


if __name__ == "__main__":
    sys.exit(main())
