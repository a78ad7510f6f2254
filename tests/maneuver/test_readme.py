"""Tests of the README: every command of its tour runs."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

README = Path(__file__).parents[2] / "README.md"

# Verbs that the README shows but that take minutes; tests of their own run them smaller.
TOO_LONG = {"demo", "regenerate"}


def commands() -> list[list[str]]:
    blocks = re.findall(r"```console\n(.*?)```", README.read_text(encoding="utf-8"), flags=re.DOTALL)
    lines = [line[2:] for block in blocks for line in block.splitlines() if line.startswith("$ ")]
    return [shlex.split(line) for line in lines if line.startswith("maneuver ")]


def test_every_command_of_the_readme_runs(tmp_path: Path) -> None:
    shown = commands()
    assert len(shown) >= 7
    for _, *arguments in shown:
        if arguments[0] in TOO_LONG:
            continue
        done = subprocess.run(
            [sys.executable, "-m", "maneuver", *arguments],
            check=False,
            cwd=tmp_path,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, (arguments, done.stdout, done.stderr)
        assert done.stdout, arguments
        assert all(line.startswith("outside the domain of ") for line in done.stderr.splitlines()), arguments


def test_every_file_that_the_readme_links_exists() -> None:
    links = re.findall(r"\]\(([^)#:]+)\)", README.read_text(encoding="utf-8"))
    assert links
    for link in links:
        assert (README.parent / link).exists(), link
