"""Film of a logged flight: chase camera, turning rotors, tracks, caption."""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from math import cos, degrees, sin
from pathlib import Path

import matplotlib
import mujoco
import numpy as np
from jaxtyping import Float
from PIL import Image, ImageDraw, ImageFont
from scipy.ndimage import gaussian_filter1d

from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind, merged_primitives
from flightlog.topics import PRIMITIVE
from flightlog.trim_labels import trim_label, trim_names
from runtime.atomic_write import file_target

from .canvas import Canvas
from .encoder import FilmError, Picture, film_encoder
from .film_model import film_model
from .film_tracks import FLOWN, PLANNED, FilmTracks

LONGEST_FILM = 6.0 * 3600.0
"""Longest flight filmed, seconds."""

# Rotor speeds in the film, rad/s, the main rotor clockwise seen from above: at the true speed the frame rate
# would alias the rotation.
_SHOWN_SPEEDS = (-11.0, 17.0)
# Camera: distance behind, m; azimuth offset and elevation, deg; smoothing of place and of heading, s.
_DISTANCE, _ASIDE, _DOWN = 7.0, -22.0, -13.0
_SMOOTH_PLACE, _SMOOTH_HEADING = 0.15, 0.9


@dataclass(frozen=True, slots=True)
class FilmSettings:
    """Size and frame rate of a film.

    Attributes:
        width: pixels, even.
        height: pixels, even.
        rate: pictures per second.
    """

    width: int = 960
    height: int = 540
    rate: int = 25

    def __post_init__(self) -> None:
        """Checks that an encoder accepts the size and the rate."""
        if self.width < 64 or self.height < 64 or self.width % 2 or self.height % 2 or self.rate < 1:
            raise ValueError(f"width and height must be even and >= 64, rate >= 1, got {self}")


class Film:
    """Pictures of one flight; the caller closes it.

    Args:
        log: the flight.
        settings: size and frame rate.

    Raises:
        FlightError: the log lacks motion or is too long, an attachment is broken, or no OpenGL context can be
            opened.
    """

    def __init__(self, log: FlightLog, settings: FilmSettings) -> None:
        if log.duration > LONGEST_FILM:
            raise FilmError(f"expected a flight of at most {LONGEST_FILM:g} s, got {log.duration:.6g} s")
        self._times = np.arange(0.0, log.duration + 0.5 / settings.rate, 1.0 / settings.rate)
        self._states = _states(log, self._times)
        self._smooth = _smooth_camera_path(self._states, settings.rate)
        self._tracks, self._captions = FilmTracks(log), _captions(log, self._times)
        self._model = film_model(log)
        self._data = mujoco.MjData(self._model)
        self._camera = mujoco.MjvCamera()
        self._camera.distance, self._camera.elevation = _DISTANCE, _DOWN
        self._canvas = Canvas(self._model, width=settings.width, height=settings.height)
        self.close = self._canvas.close

    def __len__(self) -> int:
        return len(self._times)

    def picture(self, number: int) -> Picture:
        """Renders a picture with its caption."""
        time, state = float(self._times[number]), self._states[number]
        data, camera = self._data, self._camera
        data.qpos[:7] = _mujoco_pose(state)
        rotors = self._model.nq - 7
        data.qpos[7:] = [speed * time for speed in _SHOWN_SPEEDS[:rotors]]
        mujoco.mj_kinematics(self._model, data)
        mujoco.mj_camlight(self._model, data)
        north, east, down, heading = self._smooth[number]
        camera.lookat[:] = (north, -east, -down)
        camera.azimuth = -degrees(heading) + _ASIDE

        def decorate(scene: mujoco.MjvScene) -> None:
            self._tracks.add_to(scene, time=time, place=data.qpos[:3].tolist())

        picture = self._canvas.draw(data, camera, decorate)
        return _add_caption(picture, self._captions[number])


def write_film(
    log: FlightLog,
    path: Path,
    *,
    settings: FilmSettings | None = None,
    force: bool = False,
    shown: Callable[[Iterator[int], int], Iterator[int]] | None = None,
) -> None:
    """Writes a flight as an H.264 film, atomically.

    Args:
        log: the flight.
        path: an .mp4 file.
        settings: size and frame rate.
        force: overwrite.
        shown: wraps the iterator over picture numbers, given their count, to show progress.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
        CannotWriteError: the target is not a regular file.
        FlightError: the log cannot be drawn, no OpenGL context can be opened, or the file cannot be written.
    """
    target = file_target(path, force=force)
    settings = settings or FilmSettings()
    size = {"width": settings.width, "height": settings.height, "rate": settings.rate}
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        made = Path(folder) / path.name
        with closing(Film(log, settings)) as film, film_encoder(made, **size) as add:
            numbers = iter(range(len(film)))
            for number in shown(numbers, len(film)) if shown else numbers:
                add(film.picture(number))
        made.replace(target)


def write_still(log: FlightLog, path: Path, *, time: float, settings: FilmSettings | None = None) -> None:
    """Writes one picture of a flight's film.

    Args:
        log: the flight.
        path: the picture file; overwritten.
        time: s since the start.
        settings: size and frame rate.

    Raises:
        FlightError: the time is outside the flight, the log cannot be drawn, or there is no OpenGL context.
    """
    if not 0.0 <= time <= log.duration:
        raise FilmError(f"expected a time from 0 to {log.duration:.2f} s, got {time:g} s")
    settings = settings or FilmSettings()
    with closing(Film(log, settings)) as film:
        picture = film.picture(min(round(time * settings.rate), len(film) - 1))
    try:
        Image.fromarray(picture).save(path)
    except OSError as error:
        raise FilmError(f"{path} cannot be written: {error}") from None


def _states(log: FlightLog, times: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 8"]:
    """Returns position, attitude and horizontal velocity at each time."""
    motion = log.motion
    names = ("north", "east", "down", "roll", "pitch", "heading", "forward", "side")
    return np.column_stack([np.interp(times, motion.time, motion[name]) for name in names])


def _smooth_camera_path(states: Float[np.ndarray, "n 8"], rate: int) -> Float[np.ndarray, "n 4"]:
    """Returns smoothed north, east, down and heading for the camera."""
    place = gaussian_filter1d(states[:, :3], _SMOOTH_PLACE * rate, axis=0, mode="nearest")
    heading = gaussian_filter1d(states[:, 5], _SMOOTH_HEADING * rate, mode="nearest")
    return np.column_stack([place, heading])


def _mujoco_pose(state: Float[np.ndarray, "8"]) -> tuple[float, ...]:
    """Returns position and quaternion in MuJoCo's z-up axes."""
    north, east, down, roll, pitch, heading = state[:6].tolist()
    (cr, cp, ch), (sr, sp, sh) = ([f(angle / 2.0) for angle in (roll, pitch, heading)] for f in (cos, sin))
    w, x = cr * cp * ch + sr * sp * sh, sr * cp * ch - cr * sp * sh
    y, z = cr * sp * ch + sr * cp * sh, cr * cp * sh - sr * sp * ch
    return north, -east, -down, w, x, -y, -z


def _captions(log: FlightLog, times: Float[np.ndarray, "n"]) -> list[tuple[str, str]]:
    """Returns the figures and the primitive flown, for each time."""
    states, names = _states(log, times), trim_names(log)
    primitives = merged_primitives(log) if PRIMITIVE.name in log.series else ()
    captions = []
    for time, state in zip(times.tolist(), states, strict=True):
        begun = [part for part in primitives if part.start <= time]
        primitive = ""
        if begun and begun[-1].kind is PrimitiveKind.COAST:
            primitive = f"coast in trim {trim_label(begun[-1].id, names)}"
        elif begun:
            primitive = f"maneuver to trim {trim_label(begun[-1].to_trim, names)}"
        speed = float(np.hypot(state[6], state[7]))
        captions.append((f"{time:6.2f} s    {speed:5.2f} m/s    {-state[2]:5.1f} m", primitive))
    return captions


def _add_caption(picture: Picture, caption: tuple[str, str]) -> Picture:
    """Returns the picture with a caption band at its lower edge."""
    image = Image.fromarray(picture)
    width, height = image.size
    size = max(9, height // 32)
    band = round(1.9 * size)
    image.paste(
        Image.blend(image.crop((0, height - band, width, height)), Image.new("RGB", (width, band)), 0.6),
        (0, height - band),
    )
    draw, middle = ImageDraw.Draw(image), height - band // 2
    numbers, primitive = caption
    draw.text((size, middle), numbers, font=_font("DejaVuSansMono.ttf", size), fill="white", anchor="lm")
    draw.text((width // 2, middle), primitive, font=_font("DejaVuSans.ttf", size), fill="white", anchor="mm")
    right = width - size
    for word, color in (("planned", PLANNED), ("flown", FLOWN)):
        draw.text((right, middle), word, font=_font("DejaVuSans.ttf", size), fill="white", anchor="rm")
        right -= round(draw.textlength(word, font=_font("DejaVuSans.ttf", size))) + size // 2
        fill = tuple(round(255 * part) for part in color[:3])
        draw.line((right - 2 * size, middle, right, middle), fill=fill, width=max(2, size // 5))
        right -= 3 * size
    return np.asarray(image)


@cache
def _font(name: str, size: int) -> ImageFont.FreeTypeFont:
    """Returns a font from Matplotlib's data."""
    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / name), size)
