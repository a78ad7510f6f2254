"""Tests of foreign and damaged files: a result or one error line."""

import ast
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

import models
from flight.errors import FlightError
from flightlog.consistency import check_log_consistency
from flightlog.file.reader import read_log
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import TRUTH
from flightlog.viewers.mjcf_check import parse_model
from maneuver.app import run
from tests.support.packages import ROOT, SHIPPED
from tests.support.studies.hostile_files import Kind, count_wrong, kinds_of_files, outcome
from tests.support.studies.study import Study
from tests.support.synthetic_log import synthetic_library, synthetic_log

OURS = tuple(path for name in (*SHIPPED, "tools") for path in (ROOT / name).rglob("*.py"))


@pytest.fixture(scope="module")
def kinds(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Kind]:
    return {kind.name: kind for kind in kinds_of_files(tmp_path_factory.mktemp("good"))}


@pytest.mark.parametrize(
    "name", ["library", "mission", "plan", "sequence", "vehicle", "model", "campaign", "log", "torn log"]
)
def test_a_mutated_file_is_answered_or_refused_in_one_line(
    kinds: dict[str, Kind], name: str, tmp_path: Path
) -> None:
    count = 6 if name == "log" else 25
    found = [outcome(kinds[name], Random(f"{name} {n}"), tmp_path) for n in range(count)]
    assert not [result for result in found if result.startswith("wrong")]


@pytest.mark.slow
def test_study_of_mutated_files(kinds: dict[str, Kind], study: Study, tmp_path: Path) -> None:
    assert count_wrong(kinds.values(), study, tmp_path) == 0


def test_a_file_as_it_should_be_is_accepted(kinds: dict[str, Kind], tmp_path: Path) -> None:
    for name in ("library", "plan", "sequence", "vehicle", "model", "campaign"):
        path = tmp_path / f"good{kinds[name].suffix}"
        path.write_bytes(kinds[name].content)
        assert kinds[name].use(path) == 0, name


def changed(log: FlightLog, series: Series) -> FlightLog:
    return FlightLog(log.header, {**log.series, series.topic.name: series}, log.attachments)


def test_a_log_whose_checksums_are_right_may_still_contradict_itself() -> None:
    log = synthetic_log(synthetic_library(), (1, 2), (3.0, 3.0), seed=1)
    check_log_consistency(log)
    truth = log[TRUTH]
    backwards, broken = truth.time.copy(), truth.values.copy()
    backwards[10] = 0.0
    broken[7, 2] = float("nan")
    for wrong, words in (
        (Series(TRUTH, backwards, truth.values), "expected increasing times"),
        (Series(TRUTH, truth.time, broken), "got nan"),
        (Series(TRUTH, truth.time + 500.0, truth.values), "expected a state in the primitive"),
        (Series(TRUTH, truth.time[:0], truth.values[:0]), "expected at least one message"),
    ):
        with pytest.raises(ValueError, match=words):
            check_log_consistency(changed(log, wrong))


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


def test_no_reader_executes_content_of_a_file() -> None:
    assert len(OURS) > 300
    for path in OURS:
        assert not dangers(ast.parse(path.read_text())), path


READERS = {"SeekingReader", "NonSeekingReader", "make_reader", "get_chunk_data_stream"}


def unchecked(tree: ast.AST) -> list[str]:
    """Returns the log readers without an explicit checksum check."""
    return [
        call.func.id
        for call in ast.walk(tree)
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id in READERS
        if not any(
            word.arg in {"validate_crcs", "validate_crc"} and ast.unparse(word.value) == "True"
            for word in call.keywords
        )
    ]


def test_every_reader_of_logs_verifies_checksums() -> None:
    trees = {path: ast.parse(path.read_text()) for path in OURS}
    assert not [path for path, tree in trees.items() if unchecked(tree)]
    assert unchecked(ast.parse("SeekingReader(stream)")) == ["SeekingReader"]
    assert unchecked(ast.parse("make_reader(stream, validate_crcs=False)")) == ["make_reader"]


@pytest.mark.parametrize(
    "code",
    ["eval(text)", "import pickle", "from pickle import loads", "os.system(text)", "run(text, shell=True)"],
)
def test_what_would_run_it_is_found(code: str) -> None:
    assert dangers(ast.parse(code))


SHAPE = (
    '<mujoco><worldbody><body name="helicopter"><freejoint/><geom type="box" size="{}"/></body>{}'
    "</worldbody></mujoco>"
)
HARMFUL = {
    "another file": SHAPE.format("1 1 1", '<include file="/etc/passwd"/>'),
    "an absolute path": '<mujoco><asset><mesh name="m" file="/etc/passwd"/></asset></mujoco>',
    "a folder": '<mujoco><compiler meshdir="/etc"/></mujoco>',
    "a texture's file": '<mujoco><asset><texture name="t" fileup="../t.png" type="cube"/></asset></mujoco>',
    "no number": SHAPE.format("nan 1 1", ""),
    "infinity": SHAPE.format("1e999 1 1", ""),
    "entities": '<!DOCTYPE m [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]><mujoco model="&b;"/>',
    "copies by the million": SHAPE.format("1 1 1", '<replicate count="1000000"><geom/></replicate>'),
    "a plug-in": '<mujoco><extension><plugin plugin="mujoco.elasticity.cable"/></extension></mujoco>',
    "a vast texture": '<mujoco><asset><texture type="2d" width="99999" height="9"/></asset></mujoco>',
    "too many parts": SHAPE.format("1 1 1", '<geom size="1"/>' * 3000),
    "too large": SHAPE.format("1 1 1", "<!--" + "x" * 300_000 + "-->"),
    "another encoding": "\ufeff" + SHAPE.format("1 1 1", '<include file="x"/>'),
}


@pytest.mark.parametrize("harm", HARMFUL)
def test_a_shape_that_could_do_harm_is_refused_in_one_line(harm: str) -> None:
    for encoding in ("utf-8", "utf-16"):
        with pytest.raises(FlightError) as caught:
            parse_model(HARMFUL[harm].encode(encoding), "model.xml")
        assert "\n" not in str(caught.value)
        assert str(caught.value).startswith("model.xml: ")


def test_the_shipped_shape_and_a_plain_one_are_read() -> None:
    assert parse_model((models.FOLDER / "gtmax.xml").read_bytes(), "model.xml").tag == "mujoco"
    assert parse_model(SHAPE.format("1 1 1", "").encode(), "model.xml").tag == "mujoco"


@pytest.mark.parametrize("harm", ["another file", "entities", "no number"])
def test_a_log_with_a_harmful_shape_ends_in_one_line_and_exit_code_2(
    harm: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    log = synthetic_log(synthetic_library(), (1, 2), (3.0, 3.0), seed=1)
    # Our own writer would draw the shape for viewers, and refuse.
    monkeypatch.setattr("flightlog.file.writer.viewer_channels", lambda log: ())
    path = tmp_path / "harmful.mcap"
    write_log(replace(log, attachments={**log.attachments, "model.xml": HARMFUL[harm].encode()}), path)
    assert run(["review", str(path), "--still", str(tmp_path / "still.png")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("maneuver: ")
    assert "model.xml" in line


def test_a_log_that_would_unpack_to_more_than_is_allowed_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "bomb.mcap"
    write_log(synthetic_log(synthetic_library(), (1, 2), (3.0, 3.0), seed=1), path)
    read_log(path)
    monkeypatch.setattr("flightlog.file.reader.LARGEST_LOG", path.stat().st_size)
    with pytest.raises(FlightError, match="bytes of content, got more"):
        read_log(path)
