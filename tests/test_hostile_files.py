"""Files that somebody else wrote, or broke: each ends in an answer or in one line, never in a traceback."""

import ast
from pathlib import Path
from random import Random

import pytest

import benchmarks.hostile_files as hostile
from flight.log import TRUTH, FlightLog, Series
from flight.log_check import refuse_contradictions
from tests.synthetic_log import synthetic_library, synthetic_log

ROOT = Path(__file__).parents[1]
OURS = ("flight", "sim", "identification", "planner", "review", "maneuver", "tools")


@pytest.fixture(scope="module")
def kinds(tmp_path_factory: pytest.TempPathFactory) -> dict[str, hostile.Kind]:
    return {kind.name: kind for kind in hostile.kinds(tmp_path_factory.mktemp("good"))}


@pytest.mark.parametrize("name", ["library", "mission", "plan", "sequence", "campaign", "log", "torn log"])
def test_a_mutated_file_is_answered_or_refused_in_one_line(
    kinds: dict[str, hostile.Kind], name: str, tmp_path: Path
) -> None:
    count = 6 if name == "log" else 25
    found = [hostile.outcome(kinds[name], Random(f"{name} {n}"), tmp_path) for n in range(count)]
    assert not [outcome for outcome in found if outcome.startswith("wrong")]


def test_a_file_as_it_should_be_is_accepted(kinds: dict[str, hostile.Kind], tmp_path: Path) -> None:
    for name in ("library", "plan", "sequence", "campaign"):
        path = tmp_path / f"good{kinds[name].suffix}"
        path.write_bytes(kinds[name].content)
        assert kinds[name].use(path) == 0, name


def changed(log: FlightLog, series: Series) -> FlightLog:
    return FlightLog(log.header, {**log.series, series.topic.name: series}, log.attachments)


def test_a_log_whose_checksums_are_right_may_still_contradict_itself() -> None:
    log = synthetic_log(synthetic_library(), (1, 2), (3.0, 3.0), seed=1)
    refuse_contradictions(log)
    truth = log[TRUTH]
    backwards, broken = truth.time.copy(), truth.values.copy()
    backwards[10] = 0.0
    broken[7, 2] = float("nan")
    for wrong, words in (
        (Series(TRUTH, backwards, truth.values), "time goes back"),
        (Series(TRUTH, truth.time, broken), "got nan"),
        (Series(TRUTH, truth.time + 500.0, truth.values), "has no state in the primitive"),
        (Series(TRUTH, truth.time[:0], truth.values[:0]), "has no message"),
    ):
        with pytest.raises(ValueError, match=words):
            refuse_contradictions(changed(log, wrong))


RUNNING = {"eval", "exec", "compile", "__import__"}
UNPACKING = {"pickle", "marshal", "shelve", "dill", "joblib"}
SHELLS = {("os", "system"), ("os", "popen"), ("subprocess", "getoutput")}


def dangers(tree: ast.AST) -> set[str]:
    found = set()
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name(id=name)) if name in RUNNING:
                found.add(name)
            case ast.Import(names=names):
                found |= {part.name for part in names if part.name.partition(".")[0] in UNPACKING}
            case ast.ImportFrom(module=str(name)) if name.partition(".")[0] in UNPACKING:
                found.add(name)
            case ast.Attribute(value=ast.Name(id=module), attr=name) if (module, name) in SHELLS:
                found.add(f"{module}.{name}")
            case ast.keyword(arg="shell"):
                found.add("shell")
    return found


def test_nothing_of_ours_runs_what_a_file_says() -> None:
    for path in (path for folder in OURS for path in (ROOT / folder).rglob("*.py")):
        assert not dangers(ast.parse(path.read_text())), path


@pytest.mark.parametrize(
    "code",
    ["eval(text)", "import pickle", "from pickle import loads", "os.system(text)", "run(text, shell=True)"],
)
def test_what_would_run_it_is_found(code: str) -> None:
    assert dangers(ast.parse(code))
