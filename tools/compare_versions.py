"""Comparison of two checkouts by what they compute: `python -m tools.compare_versions OLD NEW`.

A fixed set of commands runs in both, each in a folder of its own, with this interpreter: plans of every
policy, an identified library with its data sheet, logs of a sequence, a mission and a campaign, the thesis's
tables. Results that do not differ by a byte are `same`; logs are compared by their fingerprint, which leaves
out the digest of the code, plans without the time that they took. The exit code is 1 where anything differs.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

MISSIONS = ("gtmax-1", "gtmax-2", "kinematic-1", "kinematic-2")
LIBRARIES = {"gtmax": "thesis-gtmax", "kinematic": "thesis-kinematic"}
POLICIES = (
    ("nominal",),
    ("worst-case", "--gamma", "0.5"),
    ("worst-case", "--gamma", "1"),
    ("committed", "--gamma", "0.3"),
)
# Facts of a run, not of what it computes.
_TIMES = re.compile(r'"solve_time": [-+.e\d]+|"time": "[^"]*"')


def commands() -> Iterator[tuple[str, list[str]]]:
    """Yields the names of results and the commands that make them."""
    for mission in MISSIONS:
        library = LIBRARIES[mission.split("-")[0]]
        for policy, *options in POLICIES:
            yield (
                f"plan {mission} {policy} {' '.join(options)}",
                ["plan", mission, "--library", library, "--policy", policy, *options, "--json"],
            )
        yield (
            f"plan {mission}, certified",
            ["plan", mission, "--library", library, "--policy", "nominal", "--certify", "--json"],
        )
    yield "plan gtmax-2 on gtmax-sim", ["plan", "gtmax-2", "--json"]
    yield "thesis", ["thesis", "--markdown"]
    yield "library json", ["library", "show", "gtmax-sim", "--json"]
    yield "sequence.mcap", ["fly", "--sequence", "figure-eight", "--out", "sequence.mcap"]
    yield "mission.mcap", ["fly", "--mission", "gtmax-2", "--seed", "1", "--out", "mission.mcap"]
    yield "flights", ["fly", "--campaign", "gtmax", "--flights", "2", "--out", "flights"]
    yield "identified.json", ["identify", "flights", "--out", "identified.json"]


def results(checkout: Path) -> dict[str, str]:
    """Returns a digest of each result of a checkout."""
    found = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for what, words in commands():
            done = subprocess.run(
                [sys.executable, "-m", "maneuver", *words],
                check=False,
                capture_output=True,
                text=True,
                cwd=folder,
                env={**os.environ, "PYTHONPATH": str(checkout)},
            )
            out = _TIMES.sub("", done.stdout) if "--json" in words or "--markdown" in words else ""
            found[what] = _short(f"{done.returncode}{out}".encode())
            if done.returncode == 2:
                found[what] = done.stderr.strip()
        for path in sorted(path for path in folder.rglob("*") if path.is_file()):
            found[f"file {path.relative_to(folder)}"] = _file_digest(path)
    return found


def _file_digest(path: Path) -> str:
    if path.suffix != ".mcap":
        return _short(path.read_bytes())
    script = (
        "import sys; from pathlib import Path; from flightlog.file.reader import read_log; "
        "from flightlog.identity.fingerprint import fingerprint; "
        "print(fingerprint(read_log(Path(sys.argv[1]))))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, str(path)], check=True, capture_output=True, text=True
    )
    return done.stdout.strip()[:16]


def _short(content: bytes) -> str:
    return sha256(content).hexdigest()[:16]


def main() -> int:
    """Prints one line a result and returns the exit code."""
    before, after = (results(Path(word).resolve()) for word in sys.argv[1:3])
    differ = 0
    for what in dict.fromkeys([*before, *after]):
        same = before.get(what) == after.get(what)
        differ += not same
        print(
            f"{'same' if same else 'DIFFERS'}  {what}  {before.get(what)}"
            + ("" if same else f"  {after.get(what)}")
        )
    print(json.dumps({"same": len(before) - differ, "differ": differ}))
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
