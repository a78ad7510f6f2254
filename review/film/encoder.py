"""Video encoding by the ffmpeg of imageio-ffmpeg."""

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
    """A film or a still cannot be made."""


@contextmanager
def film_encoder(path: Path, *, width: int, height: int, rate: int) -> Iterator[Callable[[Picture], None]]:
    """Yields a function that appends a picture to an H.264 film.

    Args:
        path: the film file.
        width: pixels, even.
        height: pixels, even.
        rate: pictures per second.

    Raises:
        FilmError: the film cannot be written.
    """
    raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(rate), "-i", "-"]
    coded = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart"]
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", *raw, *coded, str(path)]
    with tempfile.TemporaryFile() as messages:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=messages) as encoder:
            pipe = encoder.stdin
            assert pipe is not None

            def add(picture: Picture) -> None:
                pipe.write(np.ascontiguousarray(picture).data)

            try:
                yield add
                pipe.close()
            except BrokenPipeError:
                # The encoder has exited; its messages hold the reason.
                encoder.wait()
            except BaseException:
                encoder.kill()
                encoder.wait()
                raise
        if encoder.returncode:
            messages.seek(0)
            lines = messages.read().decode(errors="replace").strip().splitlines()
            raise FilmError(f"{path} cannot be written: {lines[-1] if lines else 'the encoder failed'}")
