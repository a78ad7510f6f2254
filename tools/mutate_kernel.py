"""Measures the kernel's tests by mutation: `python -m tools.mutate_kernel --mutants 300 --seed 1`.

One change at a time to the C of planner/kernel: a sign flipped, a conj dropped, cos and sin swapped, a
threshold moved, < and <= swapped. Each is compiled in a scratch folder, and the tests marked `kernel` run on
it up to the first failure. Mutants that give the same machine code are no mutants. Survivors are printed.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import chain, zip_longest
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import perf_counter

ROOT = Path(__file__).parent.parent
KERNEL = Path("planner/kernel")

TESTS = ("-q", "-x", "-m", "kernel", "-p", "no:cacheprovider", "tests/planner/kernel")

PATIENCE = 60
"""Seconds of the processor after which a run counts as caught: the mutant has no end."""

SWAPS = {
    "+": "-",
    "-": "+",
    "+=": "-=",
    "-=": "+=",
    "*": "/",
    "/": "*",
    "<": "<=",
    "<=": "<",
    ">": ">=",
    ">=": ">",
    "==": "!=",
    "!=": "==",
    "&&": "||",
    "||": "&&",
    "cos": "sin",
    "sin": "cos",
    "acos": "asin",
    "asin": "acos",
    "ceil": "floor",
    "floor": "ceil",
    "creal": "cimag",
    "cimag": "creal",
    "cross": "dot",
    "dot": "cross",
    "MIN": "MAX",
    "MAX": "MIN",
    "fmin": "fmax",
    "fmax": "fmin",
    "INFINITY": "0.0",
}
"""Tokens and what replaces them; a `-` that is no difference is dropped."""

DROPPED = ("conj", "fabs", "sqrt", "!")
"""Tokens that are left out: what follows stays."""

TOKEN = re.compile(
    r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"])*\"|'[^']*'"
    r"|0x[0-9a-fA-F.p+-]+|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[uUlLfF]*"
    r"|[A-Za-z_]\w*|\+\+|--|->|<<|>>|[-+*/<>=!]=|&&|\|\||\S|\s+",
    re.DOTALL,
)

OPERAND = re.compile(r"[\w)\].]$")
"""After such a token a sign or a star joins two operands."""

TYPES = frozenset(("double", "int", "char", "long", "cplx", "void", "const", "unsigned", "static", "return"))


@dataclass(frozen=True, slots=True)
class Mutant:
    """One change to one source.

    Attributes:
        file: the source, in planner/kernel.
        line: where.
        kind: token that is changed.
        text: the whole source, changed.
        shown: the line, changed.
    """

    file: str
    line: int
    kind: str
    text: str
    shown: str


def mutants_of(file: str, text: str) -> Iterator[Mutant]:
    """Yields every mutant of a source."""
    before, offset, directive = "", 0, False
    for match in TOKEN.finditer(text):
        token, offset = match.group(), match.start()
        line_begin = text.rfind("\n", 0, offset) + 1
        directive = text[line_begin:offset].lstrip().startswith("#")
        if token.isspace() or token.startswith(("/*", "//", '"', "'")):
            continue
        for kind, other in _changes(token, before, directive=directive):
            changed = text[:offset] + other + text[match.end() :]
            shown = changed[line_begin:].split("\n", 1)[0].strip()
            yield Mutant(file, text.count("\n", 0, offset) + 1, kind, changed, shown)
        before = token


def _changes(token: str, before: str, *, directive: bool) -> Iterator[tuple[str, str]]:
    joins = bool(OPERAND.search(before)) and before not in TYPES
    if re.match(r"[\d.]", token) and len(token) + (token != ".") > 1:
        yield from _numbers(token, directive=directive)
    elif directive and token in ("<", ">", "-", "/"):
        return
    elif token in DROPPED:
        yield token, ""
    elif token == "-" and not joins:
        yield "minus sign", ""
    elif token == "*" and not joins:
        return
    elif token in SWAPS and (joins or token.isalpha() or token in ("&&", "||")):
        yield token, SWAPS[token]


def _numbers(token: str, *, directive: bool) -> Iterator[tuple[str, str]]:
    if re.fullmatch(r"\d+", token):
        if not directive and token in ("0", "1", "2"):
            yield "whole number", str(int(token) + 1)
    elif not token.startswith("0x"):
        yield "threshold", f"(100 * {token})"
        yield "threshold", f"(0.01 * {token})"


def drawn(count: int, chance: Random) -> list[Mutant]:
    """Returns mutants, files and kinds of change taken in turn."""
    groups: dict[tuple[str, str], list[Mutant]] = {}
    for path in sorted((ROOT / KERNEL).rglob("*.[ch]")):
        for one in mutants_of(str(path.relative_to(ROOT / KERNEL)), path.read_text()):
            groups.setdefault((one.file, one.kind), []).append(one)
    for group in groups.values():
        chance.shuffle(group)
    order = sorted(groups)
    chance.shuffle(order)
    taken = chain.from_iterable(zip_longest(*(groups[key] for key in order)))
    return [one for one in taken if one is not None][:count]


def prepared(folder: Path, mutant: Mutant | None) -> Path:
    """Returns a tree in which one source differs."""
    tree = folder / "tree"
    shutil.copytree(ROOT / "planner", tree / "planner", ignore=shutil.ignore_patterns("__pycache__"))
    for one in ROOT.iterdir():
        if one.name != "planner" and not one.name.startswith("."):
            (tree / one.name).symlink_to(one)
    if mutant is not None:
        (tree / KERNEL / mutant.file).write_text(mutant.text)
    return tree


def environment(tree: Path) -> dict[str, str]:
    """Returns the environment of a tree on its own."""
    own = {"PYTHONPATH": str(tree), "XDG_CACHE_HOME": str(tree.parent / "cache")}
    return (
        os.environ
        | own
        | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    )


BUILD = "from planner.kernel import build; assert build.__file__.startswith({!r}); build.load_kernel()"


def machine_code(tree: Path) -> bytes | None:
    """Returns the compiled kernel of a tree; None without machine code."""
    command = [sys.executable, "-c", BUILD.format(str(tree))]
    done = subprocess.run(command, cwd=tree, env=environment(tree), check=False, capture_output=True)
    made = list((tree.parent / "cache").rglob("*.so"))
    return made[0].read_bytes() if done.returncode == 0 and made else None


def outcome(mutant: Mutant, original: bytes) -> str:
    """Returns `caught`, `survived`, `equal` or `not compiled`."""
    with TemporaryDirectory() as name:
        tree = prepared(Path(name), mutant)
        code = machine_code(tree)
        if code is None:
            return "not compiled"
        if code == original:
            return "equal"
        return "caught" if tested(tree).returncode else "survived"


def tested(tree: Path) -> "subprocess.CompletedProcess[bytes]":
    """Runs the tests of a tree, within a limit of CPU seconds."""
    limited = ["sh", "-c", f'ulimit -t {PATIENCE}; exec "$@"', "sh"]
    command = [*limited, sys.executable, "-m", "pytest", *TESTS]
    return subprocess.run(command, cwd=tree, env=environment(tree), check=False, capture_output=True)


def main() -> int:
    """Prints the outcomes; returns 1 where less than 95 % were caught."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mutants", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=2)
    chosen = parser.parse_args()
    began = perf_counter()
    with TemporaryDirectory() as name:
        tree = prepared(Path(name), None)
        original = machine_code(tree)
        assert original is not None, "the kernel does not compile"
        assert tested(tree).returncode == 0, "the tests fail without a mutant"
        print(f"tests without a mutant: {perf_counter() - began:.1f} s", flush=True)
    # Some compile to the same code: more are drawn than asked for, and taken in order.
    candidates = drawn(2 * chosen.mutants, Random(chosen.seed))
    counts: Counter[str] = Counter()
    with ThreadPoolExecutor(chosen.processes) as pool:
        waiting = iter(candidates)
        while counts["caught"] + counts["survived"] < chosen.mutants:
            batch = [one for _, one in zip(range(8 * chosen.processes), waiting, strict=False)]
            if not batch:
                break
            for mutant, what in zip(batch, pool.map(lambda one: outcome(one, original), batch), strict=True):
                counts[what] += 1
                if what == "survived":
                    print(f"survived: {mutant.file}:{mutant.line} {mutant.kind}: {mutant.shown}", flush=True)
    total = counts["caught"] + counts["survived"]
    share = counts["caught"] / max(total, 1)
    print(f"{dict(counts)}: {100 * share:.1f} % of {total} caught, {perf_counter() - began:.0f} s")
    return int(share < 0.95)


if __name__ == "__main__":
    sys.exit(main())
