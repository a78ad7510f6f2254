"""Tests of interrupted campaigns and of the job store."""

import fcntl
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.campaign.fly_campaign import CampaignOrder, CampaignResult, fly_campaign
from experiments.mission.mission_task import MissionTask
from experiments.mission.result_store import FLIGHTS, fly_tasks, stored_tasks
from flight.automaton.library import Library
from flight.errors import AlreadyExistsError, CannotWriteError, FlightError
from flightlog.file.reader import read_log
from runtime import atomic_write as publishing
from runtime.atomic_write import FileSystem, write_atomically
from runtime.executor import JobExecutor
from runtime.job import CodeMismatchError, JobState
from runtime.job_store import BusyError, inspect_jobs
from scenarios.find import find_campaign, find_library, find_mission
from tests.support.small_campaign import write_small_campaign


@pytest.fixture(scope="module")
def order(tmp_path_factory: pytest.TempPathFactory) -> CampaignOrder:
    path = write_small_campaign(tmp_path_factory.mktemp("campaign"), flights=3)
    return CampaignOrder(find_campaign(str(path)), seed=1, flights=3, wind="gtmax")


@pytest.fixture
def job_executor() -> Iterator[JobExecutor]:
    with ThreadPoolExecutor(1) as executor:
        yield JobExecutor(executor)


@pytest.fixture(scope="module")
def undisturbed(order: CampaignOrder, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    folder = tmp_path_factory.mktemp("whole") / "flights"
    with ThreadPoolExecutor(1) as executor:
        fly_campaign(order, folder, job_executor=JobExecutor(executor))
    return contents(folder)


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def begin(folder: Path, undisturbed: dict[str, bytes], count: int) -> None:
    folder.mkdir()
    for name, content in list(undisturbed.items())[:count]:
        (folder / name).write_bytes(content)


def test_a_campaign_that_was_stopped_flies_only_what_is_missing(
    order: CampaignOrder,
    job_executor: JobExecutor,
    undisturbed: dict[str, bytes],
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    folder = tmp_path / "flights"
    begin(folder, undisturbed, 2)
    before = {path: path.stat().st_mtime_ns for path in folder.iterdir()}
    flown = fly_campaign(order, folder, job_executor=job_executor)
    assert {path: path.stat().st_mtime_ns for path in before} == before
    assert contents(folder) == undisturbed
    assert capsys.readouterr().err == "2 of 3 already done\n"
    assert [flight.path.name for flight in flown.flights] == list(undisturbed)
    # Stored results equal flown ones.
    assert fly_campaign(order, folder, job_executor=job_executor) == flown


def test_files_sent_by_value_are_those_that_workers_write(
    order: CampaignOrder, job_executor: JobExecutor, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    fly_campaign(order, tmp_path / "flights", job_executor=replace(job_executor, by_value=True))
    assert contents(tmp_path / "flights") == undisturbed


def test_a_longer_campaign_goes_on_from_a_shorter_one(
    order: CampaignOrder, job_executor: JobExecutor, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    fly_campaign(replace(order, flights=1), tmp_path / "flights", job_executor=job_executor)
    fly_campaign(order, tmp_path / "flights", job_executor=job_executor)
    assert contents(tmp_path / "flights") == undisturbed
    with pytest.raises(FlightError, match=r"expected only files of this command, got small-0002\.mcap"):
        fly_campaign(replace(order, flights=2), tmp_path / "flights", job_executor=job_executor)


def test_a_damaged_log_is_flown_again_and_a_half_written_one_is_cleared_away(
    order: CampaignOrder, job_executor: JobExecutor, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    folder = tmp_path / "flights"
    begin(folder, undisturbed, 3)
    damaged = folder / "small-0001.mcap"
    damaged.write_bytes(damaged.read_bytes()[:-5000])
    (folder / ".small-0002.mcap.12345678.partial").write_bytes(b"half")
    store = inspect_jobs(order.jobs(folder), folder)
    assert store.paths(JobState.DAMAGED) == (damaged,)
    assert [path.name for path in store.partial_files] == [".small-0002.mcap.12345678.partial"]
    fly_campaign(order, folder, job_executor=job_executor)
    assert contents(folder) == undisturbed


@pytest.mark.parametrize("change", ["seed", "wind from", "library", "code"])
def test_the_log_of_another_flight_is_not_taken_for_ours(
    order: CampaignOrder,
    undisturbed: dict[str, bytes],
    tmp_path: Path,
    change: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    folder, job_executor = tmp_path / "flights", JobExecutor(ThreadPoolExecutor(1))
    begin(folder, undisturbed, 1)
    wanted = order
    match change:
        case "seed":
            wanted = replace(order, seed=2)
        case "wind from":
            wanted = replace(order, flight_options=replace(order.flight_options, adaptive=False))
        case "library":
            wanted = replace(order, campaign=replace(order.campaign, coasting_range=(0.5, 1.6)))
        case "code":
            monkeypatch.setattr("sim.flight_header.code_version", lambda: "0.1.0+000000000000")
    with pytest.raises(FlightError, match=r"small-0000\.mcap is of another flight: expected"):
        fly_campaign(wanted, folder, job_executor=job_executor)
    assert contents(folder) == dict(list(undisturbed.items())[:1])
    if change == "seed":
        fly_campaign(wanted, folder, job_executor=job_executor, force=True)
        assert inspect_jobs(wanted.jobs(folder), folder).complete


def test_a_folder_with_other_files_is_not_changed(
    order: CampaignOrder, job_executor: JobExecutor, tmp_path: Path
) -> None:
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(AlreadyExistsError):
        fly_campaign(order, tmp_path, job_executor=job_executor)


def test_two_programs_do_not_write_into_one_folder(
    order: CampaignOrder, job_executor: JobExecutor, tmp_path: Path
) -> None:
    folder = tmp_path / "flights"
    folder.mkdir()
    descriptor = os.open(folder, os.O_RDONLY)
    fcntl.flock(descriptor, fcntl.LOCK_EX)
    try:
        with pytest.raises(BusyError, match="is locked by another program"):
            fly_campaign(order, folder, job_executor=job_executor)
    finally:
        os.close(descriptor)


def test_a_worker_with_other_code_refuses_to_fly(order: CampaignOrder, tmp_path: Path) -> None:
    flight = replace(order.jobs(tmp_path)[0], code="0.1.0+other")
    with pytest.raises(CodeMismatchError, match=r"expected code 0\.1\.0\+other on every worker"):
        flight.run()


class _FullFileSystem(FileSystem):
    """File system with room for a few more bytes."""

    def __init__(self, free: int) -> None:
        self.free = free

    def write(self, descriptor: int, content: bytes) -> int:
        if not self.free:
            raise OSError(28, "No space left on device")
        taken = super().write(descriptor, content[: self.free])
        self.free -= taken
        return taken


def test_a_full_disk_ends_a_campaign_in_one_line_and_it_goes_on_with_room(
    order: CampaignOrder, job_executor: JobExecutor, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    folder, file_system = tmp_path / "flights", _FullFileSystem(2_500_000)

    def write(content: bytes, path: Path) -> None:
        write_atomically(content, path, force=True, file_system=file_system)

    with pytest.raises(CannotWriteError, match="cannot be written: No space left on device"):
        fly_campaign(order, folder, job_executor=replace(job_executor, by_value=True, write=write))
    assert contents(folder).items() < undisturbed.items()
    fly_campaign(order, folder, job_executor=job_executor)
    assert contents(folder) == undisturbed


def test_a_written_file_is_on_the_disk_with_its_name_and_its_folders(
    tmp_path: Path,
) -> None:
    steps: list[str] = []

    class Noting(FileSystem):
        def sync(self, descriptor: int) -> None:
            steps.append("sync")
            super().sync(descriptor)

        def rename(self, path: Path, target: Path) -> None:
            steps.append(f"rename {target.name}")
            super().rename(path, target)

        def sync_folder(self, path: Path) -> None:
            steps.append(f"sync {path.name}/")
            super().sync_folder(path)

    write_atomically(b"content", tmp_path / "new" / "newer" / "file", file_system=Noting())
    assert steps == [f"sync {tmp_path.name}/", "sync new/", "sync", "rename file", "sync newer/"]
    assert publishing.partial_files(tmp_path / "new" / "newer") == []


@pytest.fixture(scope="module")
def library() -> Library:
    return find_library("gtmax-sim")


def test_a_validation_keeps_whole_flights_of_its_own_and_no_others(
    library: Library, job_executor: JobExecutor, tmp_path: Path
) -> None:
    out, logs = tmp_path / "out", tmp_path / "logs"
    task = MissionTask(
        find_mission("gtmax-2"), library, "nominal", 0.0, "gtmax", 1, log=logs / "one.mcap", force=True
    )

    def fly(wanted: MissionTask) -> float:
        return fly_tasks([wanted], folder=out, logs=logs, job_executor=job_executor, force=False)[
            0
        ].flown_time

    first, log = fly(task), (logs / "one.mcap").read_bytes()
    (result,) = (out / FLIGHTS).iterdir()
    text = result.read_text()
    # A changed digit is detected although it is still a number.
    assert f'"flown_time":{first}' in text
    result.write_text(text.replace(f'"flown_time":{first}', '"flown_time":1.25'))
    assert stored_tasks([task], out / FLIGHTS)[0].status().state is JobState.DAMAGED
    assert fly(task) == first
    # Without its log a flight is missing; flown again it is the same.
    (logs / "one.mcap").unlink()
    assert fly(task) == first
    assert (logs / "one.mcap").read_bytes() == log
    with pytest.raises(FlightError, match=r"one\.mcap is of another flight: expected seed 2"):
        fly(replace(task, seed=2))
    assert (logs / "one.mcap").read_bytes() == log


def test_a_campaigns_result_has_duration_and_outcomes_of_its_flights(
    order: CampaignOrder, job_executor: JobExecutor, tmp_path: Path
) -> None:
    flown: CampaignResult = fly_campaign(order, tmp_path / "flights", job_executor=job_executor)
    logs = [read_log(flight.path) for flight in flown.flights]
    assert flown.duration == pytest.approx(sum(log.duration for log in logs))
    assert {flight.outcome for flight in flown.flights} == {"completed"}
