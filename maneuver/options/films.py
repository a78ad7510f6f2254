"""Films and stills of logged flights, for `fly` and `review`."""

from pathlib import Path

from flightlog.log import FlightLog
from runtime.atomic_write import check_output_files
from runtime.progress import show_progress

FILM_ENDING, STILL_ENDING = ".mp4", ".png"


def check_film_target(path: Path, *, force: bool) -> None:
    """Checks before a flight that its film can be made.

    Raises:
        FlightError: the name does not end with .mp4, the file exists, or there is no OpenGL.
    """
    from review.film.canvas import check_canvas

    check_output_files(path, force=force, ending=FILM_ENDING)
    check_canvas()


def make_film(log: FlightLog, path: Path, *, force: bool) -> None:
    """Films a flight.

    Raises:
        FlightError: the film cannot be made.
    """
    from review.film.film import write_film

    check_film_target(path, force=force)
    write_film(
        log,
        path,
        force=force,
        shown=lambda numbers, total: show_progress(numbers, total=total, what="filming"),
    )


def make_still(log: FlightLog, path: Path, *, time: float, force: bool) -> None:
    """Draws one picture of a flight's film.

    Raises:
        FlightError: the picture cannot be made.
    """
    from review.film.film import write_still

    check_output_files(path, force=force, ending=STILL_ENDING)
    write_still(log, path, time=time)
