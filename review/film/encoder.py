"""Pictures written to a film, by the ffmpeg that imageio-ffmpeg brings."""

import subprocess
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from jaxtyping import UInt8

from flight.errors import FlightError

Picture = UInt8[np.ndarray, "height width 3"]


class FilmError(FlightError):
    """A film or a picture of one cannot be made."""


@contextmanager
def film_encoder(path: Path, *, width: int, height: int, rate: int) -> Iterator[Callable[[Picture], None]]:
    """Lends what adds a picture to a film in H.264.

    Args:
        path: of the film.
        width: pixels, even.
        height: pixels, even.
        rate: pictures a second.

    Raises:
        FilmError: the film cannot be written.
    """
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(rate), "-i", "-"]
    coded = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart"]
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", *raw, *coded, str(path)]
    with tempfile.TemporaryFile() as said:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as encoder:
            taking = encoder.stdin
            assert taking is not None

            def add(picture: Picture) -> None:
                taking.write(np.ascontiguousarray(picture).data)

            try:
                yield add
                taking.close()
            except BrokenPipeError:
                # It has ended, and said why.
                encoder.wait()
            except BaseException:
                encoder.kill()
                encoder.wait()
                raise
        if encoder.returncode:
            said.seek(0)
            lines = said.read().decode(errors="replace").strip().splitlines()
            raise FilmError(f"{path} cannot be written: {lines[-1] if lines else 'the encoder failed'}")
