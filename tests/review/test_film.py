"""Tests of films of logged flights."""

import subprocess
from functools import cache
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from experiments.campaign.fly_campaign import campaign_library
from experiments.mission.fly import fly_helicopter
from experiments.mission.mission_task import MissionTask
from flight.automaton.library import Library
from flight.errors import AlreadyExistsError, BadFileError
from flightlog.attachment_names import MODEL_ATTACHMENT
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from flightlog.topics import TRUTH
from maneuver.app import run
from review.film import film as filming
from review.film.canvas import NoCanvasError, check_canvas
from review.film.encoder import FilmError, film_encoder
from review.film.film import Film, FilmSettings, write_film, write_still
from review.film.film_model import film_model
from review.film.film_tracks import planned_tracks
from scenarios.find import find_campaign, find_mission
from sim.campaign_flight import fly_sequence
from sim.loop.specification import FlightSpecification
from sim.simulated_helicopter import SimulatedHelicopter

SMALL = FilmSettings(width=192, height=108, rate=10)


def can_draw() -> bool:
    try:
        check_canvas()
    except NoCanvasError:
        return False
    return True


needs_canvas = pytest.mark.skipif(not can_draw(), reason="there is no OpenGL")


@cache
def library() -> Library:
    return campaign_library(find_campaign("gtmax"), "calm")


@cache
def flown() -> FlightLog:
    flight = FlightSpecification(seed=1, start_trim=3, settling_time=1.0, trims=(3,), coasting_times=(1.5,))
    helicopter = SimulatedHelicopter(flight, library())
    fly_sequence(helicopter, flight.sequence, library=library())
    return helicopter.log()


def pictures_of(path: Path) -> tuple[np.ndarray, str]:
    """Returns the pictures of a small film and ffmpeg's messages."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(command, capture_output=True, check=True)
    shape = (-1, SMALL.height, SMALL.width, 3)
    return np.frombuffer(done.stdout, np.uint8).reshape(shape), done.stderr.decode()


@needs_canvas
def test_a_film_has_the_flights_length_and_moves(tmp_path: Path) -> None:
    path = tmp_path / "flight.mp4"
    write_film(flown(), path, settings=SMALL)
    pictures, said = pictures_of(path)
    assert len(pictures) == 16
    assert "192x108" in said
    assert "Duration: 00:00:01.60" in said
    assert "10 fps" in said
    first, second, last = (pictures[place].astype(int) for place in (0, 1, -1))
    assert np.abs(last - first).max() > 60
    assert np.abs(second - first).max() > 60
    assert [entry.name for entry in tmp_path.iterdir()] == ["flight.mp4"]


@needs_canvas
def test_one_moment_is_one_picture_and_the_vehicle_is_in_its_middle() -> None:
    film = Film(flown(), SMALL)
    again, once = film.picture(3), film.picture(3)
    assert again.tobytes() == once.tobytes()
    assert film.picture(4).tobytes() != once.tobytes()
    film.close()
    middle, sky, ground = once[46:58, 88:104].astype(int), once[5, 5], once[80, 20]
    # Red cowling or white fuselage in the middle, blue above, green below.
    assert (middle[..., 0] - middle[..., 1]).max() > 60
    assert sky[2] > sky[0]
    assert ground[1] > max(ground[0], ground[2])


def test_the_filmed_attitude_is_the_flown_one() -> None:
    flight = FlightSpecification(seed=2, wind="gtmax", start_trim=7, trims=(7,), coasting_times=(1.0,))
    helicopter = SimulatedHelicopter(flight, library())
    helicopter.coast(1.0)
    state = helicopter._helicopter.state()
    truth = helicopter.log()[TRUTH].values[-1]
    placed = np.array(filming._mujoco_pose(truth[[0, 1, 2, 6, 7, 8, 3, 4]]))
    north, east, down = state.position
    w, x, y, z = state.quaternion
    assert abs(truth[6]) > 0.05
    np.testing.assert_allclose(placed[:3], (north, -east, -down), atol=1e-9)
    expected = np.array((w, x, -y, -z))
    np.testing.assert_allclose(placed[3:] * np.sign(placed[3] * w), expected, atol=1e-9)


def test_the_film_has_rotors_that_turn_and_the_weight_of_none() -> None:
    model = film_model(flown())
    assert [model.joint(place).name for place in range(model.njnt)] == ["flight", "blade", "tail_blade"]
    bare = (
        b'<mujoco><worldbody><body name="helicopter"><freejoint/><geom size="1"/></body></worldbody></mujoco>'
    )
    other = film_model(FlightLog(flown().header, flown().series, {MODEL_ATTACHMENT: bare}))
    assert other.nq == 7
    with pytest.raises(BadFileError, match=r"model\.xml: expected a drawable model"):
        film_model(FlightLog(flown().header, flown().series, {MODEL_ATTACHMENT: b"<nonsense>"}))


def test_a_sequence_shows_its_walk_and_a_mission_every_plan_from_when_it_was_made() -> None:
    (walk,) = planned_tracks(flown())
    motion = flown()[TRUTH]
    np.testing.assert_allclose(walk.lines[0][-1, :2], (motion["north"][-1], -motion["east"][-1]), atol=0.3)
    assert walk.time == 0.0
    mission = find_mission("gtmax-1")
    _, log = fly_helicopter(
        MissionTask(mission=mission, library=library(), policy="nominal", gamma=0.0, wind="calm", seed=1)
    )
    plans = planned_tracks(log)
    assert len(plans) > 1
    assert sorted(plan.time for plan in plans) == [plan.time for plan in plans]
    assert plans[0].lines[0][0, :2] == pytest.approx((mission.start.x, -mission.start.y), abs=0.5)
    assert planned_tracks(FlightLog(log.header, log.series, {})) == ()


@needs_canvas
def test_a_still_is_a_picture_of_its_moment(tmp_path: Path) -> None:
    path = tmp_path / "still.png"
    write_still(flown(), path, time=1.0, settings=SMALL)
    with Image.open(path) as picture:
        assert picture.size == (192, 108)
    with pytest.raises(FilmError, match=r"expected a time from 0 to 1\.50 s, got 9 s"):
        write_still(flown(), path, time=9.0, settings=SMALL)


@needs_canvas
def test_a_film_that_breaks_off_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(film: Film, number: int) -> np.ndarray:
        raise KeyboardInterrupt

    monkeypatch.setattr(Film, "picture", broken)
    with pytest.raises(KeyboardInterrupt):
        write_film(flown(), tmp_path / "flight.mp4", settings=SMALL)
    assert list(tmp_path.iterdir()) == []


def test_what_the_encoder_refuses_is_said(tmp_path: Path) -> None:
    nowhere = tmp_path / "nowhere" / "flight.mp4"
    with pytest.raises(FilmError, match="No such file or directory"):
        write_black(nowhere, pictures=50)


def write_black(path: Path, *, pictures: int) -> None:
    with film_encoder(path, width=SMALL.width, height=SMALL.height, rate=SMALL.rate) as add:
        for _ in range(pictures):
            add(np.zeros((SMALL.height, SMALL.width, 3), np.uint8))


def test_a_film_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "flight.mp4"
    path.write_text("mine")
    with pytest.raises(AlreadyExistsError, match="--force"):
        write_film(flown(), path, settings=SMALL)


def test_without_opengl_there_is_one_line_and_no_flight(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("MUJOCO_GL", "nothing")
    monkeypatch.chdir(tmp_path)
    assert run(["fly", "--sequence", "figure-eight", "--video", "eight.mp4"]) == 2
    said = capsys.readouterr().err
    assert "expected off-screen OpenGL" in said
    assert len(said.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (
            ["--sequence", "figure-eight", "--video", "eight.avi"],
            "ends with .mp4, got eight.avi",
        ),
        (["--campaign", "gtmax", "--video", "all.mp4"], "--video: expected --sequence or --mission"),
    ],
)
def test_films_that_cannot_be_are_refused_before_flying(
    arguments: list[str],
    line: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(["fly", *arguments]) == 2
    assert line in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


@needs_canvas
def test_review_films_a_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(filming, "FilmSettings", lambda: SMALL)
    write_log(flown(), tmp_path / "flight.mcap")
    assert run(["review", "flight.mcap", "--video", "film.mp4", "--still", "still.png", "--at", "1"]) == 0
    assert len(pictures_of(Path("film.mp4"))[0]) == 16
    with Image.open("still.png") as picture:
        assert picture.size == (192, 108)
