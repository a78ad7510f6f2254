"""Tests of bit identity of one campaign flown in several ways."""

from pathlib import Path

import pytest

from maneuver.app import run
from tests.support.studies.bit_identity import Ways, hash_of, hashes
from tests.support.studies.study import Study

THREADS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")


def test_order_interruption_and_threads_do_not_show_in_logs_and_library(tmp_path: Path) -> None:
    ways = Ways(tmp_path, flights=2)
    plain = ways.by_command("1 worker", "--workers", "1", environment=dict.fromkeys(THREADS, "1"))
    assert ways.shuffled() == plain
    assert ways.resumed() == plain
    assert ways.by_command("threads", "--workers", "1", environment=dict.fromkeys(THREADS, "4")) == plain
    assert ways.replayed() == (0, 2)


@pytest.mark.slow
def test_study_of_the_ways_to_fly_one_campaign(study: Study, tmp_path: Path) -> None:
    flights, found = study.size("flights", 3), set()
    for way, digest in hashes(tmp_path, flights=flights, workers=(1, 2, 8)):
        study.show(f"{digest}  {way}")
        found.add(digest)
    differ, logs = Ways(tmp_path, flights=flights).replayed()
    study.show_share(differ, logs, "logs flown again from themselves")
    assert len(found) == 1
    assert (differ, logs) == (0, flights)


def test_another_seed_has_another_hash(tmp_path: Path) -> None:
    found = []
    for seed in ("1", "2"):
        folder = tmp_path / seed
        folder.mkdir()
        words = ["fly", "--sequence", "slow-walk", "--seed", seed, "--out", str(folder / "log.mcap")]
        assert run(words) == 0
        found.append(hash_of(folder))
    assert found[0] != found[1]
