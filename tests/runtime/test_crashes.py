"""Tests of campaigns after a crash at any step."""

from collections import Counter
from pathlib import Path
from random import Random

import pytest

from runtime.atomic_write import write_atomically
from tests.support.studies.crash_disk import Loss, NotingDisk, after_crash
from tests.support.studies.crash_kills import killed
from tests.support.studies.crash_sweep import (
    Sweep,
    crash_everywhere,
    fill_everywhere,
    naive_writer,
    note,
    whole_writer,
)
from tests.support.studies.study import Study

PIECE = 700_000
SMALL_PIECE = 128 * 1024


@pytest.fixture(scope="module")
def sweep(tmp_path_factory: pytest.TempPathFactory) -> Sweep:
    return Sweep.of(tmp_path_factory.mktemp("sweep"), flights=1)


def test_after_a_crash_at_any_step_nothing_is_lost_doubled_or_incomplete(sweep: Sweep) -> None:
    counts = crash_everywhere(sweep, whole_writer, piece=PIECE, seed=1)
    assert counts.keys() == {*Loss}
    steps, _ = note(sweep, whole_writer, piece=PIECE)
    assert all(found == Counter(points=len(steps) + 1) for found in counts.values())


def test_a_writer_that_opens_files_in_their_place_is_caught_at_most_points(sweep: Sweep) -> None:
    counts = crash_everywhere(sweep, naive_writer, piece=PIECE, seed=1)
    assert all(found["caught"] > 0 for found in counts.values())
    total = sum(counts.values(), Counter[str]())
    assert total["caught"] > total["points"] / 2


def test_a_writer_that_does_not_sync_is_caught_only_where_the_machine_stops(sweep: Sweep) -> None:
    class Hasty(NotingDisk):
        def sync(self, descriptor: int) -> None:
            pass

    def caught(loss: Loss) -> int:
        file_system, reported = Hasty(PIECE), list[tuple[int, str]]()
        sweep.lay_out({})
        sweep.run(whole_writer, file_system, reported=reported)
        wrong = 0
        for number in range(len(file_system.steps) + 1):
            found = sweep.relative(after_crash(file_system.steps[:number], loss, Random(number)))
            wrong += bool(sweep.faults(found, {name for step, name in reported if step <= number}))
        return wrong

    assert caught(Loss.KILLED) == 0
    assert caught(Loss.DROPPED) > 0
    assert caught(Loss.NAMES_FIRST) > 0


def test_a_disk_that_is_full_from_any_step_on_leaves_a_campaign_that_goes_on(sweep: Sweep) -> None:
    counts = fill_everywhere(sweep, piece=PIECE)
    assert counts == Counter(points=len(note(sweep, whole_writer, piece=PIECE)[0]))


def test_a_campaign_killed_again_and_again_comes_to_the_same_library() -> None:
    counts = killed(2, flights=6, workers=1, seed=2)
    assert counts.pop("campaigns finished") > 0
    assert counts == {"kills": 2}


@pytest.mark.slow
def test_study_of_crashes_at_every_step(study: Study, tmp_path: Path) -> None:
    sweep, seed = Sweep.of(tmp_path, flights=study.size("flights", 3)), study.size("seed", 1)
    caught = {}
    for name, writer in (("the program's writer", whole_writer), ("a naive writer", naive_writer)):
        counts = crash_everywhere(sweep, writer, piece=SMALL_PIECE, seed=seed)
        for loss, found in counts.items():
            study.show_share(found["caught"], found["points"], f"{name}, {loss}")
        total = sum(counts.values(), Counter[str]())
        study.show_share(total["caught"], total["points"], f"{name}, all")
        caught[writer] = total["caught"] / total["points"]
    full = fill_everywhere(sweep, piece=SMALL_PIECE)
    study.show_share(full["caught"], full["points"], "the program's writer, disk full")
    assert caught[whole_writer] == full["caught"] == 0
    assert caught[naive_writer] > 0.5


@pytest.mark.slow
def test_study_of_campaigns_killed_at_random(study: Study) -> None:
    kills, flights = study.size("kills", 20), study.size("flights", 2)
    counts = killed(kills, flights=flights, workers=study.size("workers", 1), seed=study.size("seed", 1))
    for what, count in sorted(counts.items()):
        study.show(f"{count:5d} {what}")
    wrong = sum(count for what, count in counts.items() if what.startswith("wrong"))
    study.show_share(wrong, counts["kills"], "kills")
    assert counts["kills"] == kills
    assert wrong == 0


def test_what_was_synced_outlives_the_machine_and_what_was_not_may_go(tmp_path: Path) -> None:
    file_system, path = NotingDisk(5000), tmp_path / "file"
    write_atomically(bytes(range(1, 250)) * 40, path, file_system=file_system)
    whole = path.read_bytes()
    steps = [step.what for step in file_system.steps]
    assert steps == ["open", "write", "write", "sync", "rename", "sync folder"]
    synced = {loss: after_crash(file_system.steps, loss, Random(1)) for loss in Loss}
    assert all(found == {path: whole} for found in synced.values())
    # Before the folder is synced the name may be gone, the content not; before that, both.
    assert after_crash(file_system.steps[:5], Loss.DROPPED, Random(1)) == {}
    assert after_crash(file_system.steps[:5], Loss.NAMES_FIRST, Random(1)) == {path: whole}
    assert after_crash(file_system.steps[:2], Loss.KILLED, Random(1)).popitem()[1] == whole[:5000]
    torn = {bytes(*after_crash(file_system.steps[:3], Loss.TORN, Random(n)).values()) for n in range(20)}
    assert len(torn) > 5
    assert all(byte in {0, written} for one in torn for byte, written in zip(one, whole, strict=False))
