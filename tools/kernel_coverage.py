"""Lines of the kernel's C that no test executes: `python -m tools.kernel_coverage -m kernel tests/planner`.

Arguments go to pytest. The kernel is compiled with counters of gcov, not optimised, in a cache of its own.
"""

import gzip
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from planner.kernel.build import SOURCES
from runtime import compiler

FOLDER = "KERNEL_COVERAGE"
"""Variable of the environment: where the counters are written."""

LINES = dict[tuple[str, int], int]


def pytest_configure() -> None:
    """Compiles with counters, as a plugin of pytest."""
    folder, compile_ = os.environ[FOLDER], compiler._compile

    def compile_counting(sources: Sequence[Path], path: Path, flags: Sequence[str]) -> None:
        counting = "-O0", "--coverage", "-fprofile-abs-path", "-dumpdir", f"{folder}/{path.stem}-"
        compile_(sources, path, (*flags, *counting))

    compiler._compile = compile_counting


def executions(folder: Path) -> Counter[tuple[str, int]]:
    """Returns the executions of each kernel line, over all builds."""
    known = {str(source): str(source.relative_to(source.parents[1])) for source in SOURCES}
    found: Counter[tuple[str, int]] = Counter()
    for path in sorted(folder.glob("*.gcda")):
        command = ["gcov", "--json-format", path.name]
        subprocess.run(command, cwd=folder, check=True, capture_output=True)
        written = next(folder.glob("*.gcov.json.gz"))
        for file in json.loads(gzip.decompress(written.read_bytes()))["files"]:
            for line in file["lines"]:
                if file["file"] in known:
                    found[known[file["file"]], line["line_number"]] += line["count"]
        written.unlink()
    return found


def main(arguments: Sequence[str]) -> int:
    """Prints lines that were not executed; returns 1 for some."""
    with TemporaryDirectory() as name:
        own = {FOLDER: name, "XDG_CACHE_HOME": name}
        command = [sys.executable, "-m", "pytest", "-q", "-p", "tools.kernel_coverage", *arguments]
        subprocess.run(command, env=os.environ | own, check=True)
        counts = executions(Path(name))
    missed = sorted(place for place, count in counts.items() if not count)
    for file, number in missed:
        text = next(source for source in SOURCES if str(source).endswith(f"/{file}")).read_text()
        print(f"{file}:{number}: {text.splitlines()[number - 1].strip()}")
    print(f"{len(missed)} of {len(counts)} lines were not executed")
    return int(bool(missed))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
