"""Tests of campaigns on a Dask cluster with two workers."""

import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from flight.errors import FlightError
from maneuver.app import run
from runtime.cluster import NoClusterError, cluster_executor
from tests.support.small_campaign import write_small_campaign
from tests.support.studies.local_cluster import Cluster, local_cluster

pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Cluster]:
    with local_cluster(tmp_path_factory.mktemp("cluster")) as lent:
        yield lent


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_missions_and_libraries_come_from_a_cluster_with_the_same_bytes(
    cluster: Cluster, tmp_path: Path
) -> None:
    file, _ = cluster
    campaign = write_small_campaign(tmp_path, flights=2)
    grid = ["--missions", "gtmax-2", "--policies", "nominal", "--flights", "1"]
    for place, more in (("here", ["--workers", "1"]), ("there", ["--cluster", str(file)])):
        out, logs = tmp_path / place, tmp_path / f"{place}-logs"
        out.mkdir()
        make = ["regenerate", "--campaign", str(campaign), "--out", str(out / "made.json")]
        assert run([*make, *more]) == 0
        assert run(["validate", *grid, *more, "--out", str(out / "grid"), "--logs", str(logs)]) in {0, 1}
    assert contents(tmp_path / "here-logs") == contents(tmp_path / "there-logs")
    for name in ("made.json", "made.md"):
        assert (tmp_path / "here" / name).read_bytes() == (tmp_path / "there" / name).read_bytes()


def test_a_cluster_that_does_not_answer_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("runtime.cluster.CONNECTION_TIMEOUT", 1)
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{unused.getsockname()[1]}"
        words = ["fly", "--campaign", "gtmax", "--out", str(tmp_path / "out"), "--cluster", address]
        assert run(words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"maneuver: --cluster {address}: expected a Dask scheduler, got")
    assert not (tmp_path / "out").exists()
    with pytest.raises(NoClusterError, match="expected a Dask scheduler"), cluster_executor("no address"):
        pass


def test_without_the_extra_a_cluster_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with (
        pytest.raises(FlightError, match=r"pip install 'maneuver-automaton\[cluster\]'"),
        cluster_executor("x"),
    ):
        pass


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--shared-folder"], "--shared-folder: expected --cluster, got none"),
        (["--cluster", "tcp://127.0.0.1:1", "--workers", "2"], "a cluster has its own"),
    ],
)
def test_options_that_contradict_each_other_are_refused(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["fly", "--campaign", "gtmax", *words]) == 2
    assert message in capsys.readouterr().err


def test_workers_that_share_the_folder_write_into_it_themselves(cluster: Cluster, tmp_path: Path) -> None:
    file, _ = cluster
    words = ["fly", "--campaign", str(write_small_campaign(tmp_path, flights=2))]
    out, here = tmp_path / "cluster", tmp_path / "here"
    assert run([*words, "--out", str(out), "--cluster", str(file), "--shared-folder"]) == 0
    assert run([*words, "--out", str(here), "--workers", "1"]) == 0
    assert contents(out) == contents(here)


def test_a_campaign_on_a_cluster_loses_nothing_when_a_worker_is_killed(
    cluster: Cluster, tmp_path: Path
) -> None:
    file, (_, victim, _) = cluster
    words = ["fly", "--campaign", str(write_small_campaign(tmp_path, flights=16))]
    out, here = tmp_path / "cluster", tmp_path / "here"
    command = [sys.executable, "-m", "maneuver", *words, "--out", str(out), "--cluster", str(file)]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while process.poll() is None and len(list(out.glob("[!.]*"))) < 2:
            time.sleep(0.02)
        there = len(list(out.glob("[!.]*")))
        victim.send_signal(signal.SIGKILL)
    assert 0 < there < 16
    assert process.returncode == 0
    assert run([*words, "--out", str(here), "--workers", "1"]) == 0
    assert contents(out) == contents(here)
    assert len(contents(out)) == 16


def test_a_campaign_whose_scheduler_dies_ends_in_one_line_and_goes_on_here(
    cluster: Cluster, tmp_path: Path
) -> None:
    file, (scheduler, *_) = cluster
    words = [
        "fly",
        "--campaign",
        str(write_small_campaign(tmp_path, flights=8)),
        "--out",
        str(tmp_path / "out"),
    ]
    command = [sys.executable, "-m", "maneuver", *words, "--cluster", str(file)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        while process.poll() is None and not list(tmp_path.glob("out/[!.]*")):
            time.sleep(0.02)
        scheduler.kill()
        message = process.communicate()[1]
    assert process.returncode == 2
    assert len(message.splitlines()) == 1
    assert "repeat the command to resume" in message
    assert len(contents(tmp_path / "out")) < 8
    assert run([*words, "--workers", "1"]) == 0
    assert len(contents(tmp_path / "out")) == 8
