"""`maneuver review`: a flight log as summary, page, pictures and film."""

import json as json_module
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.types import NonNegativeInt
from rich.console import Console

from flight.automaton.library import Library
from flight.errors import FlightError
from flightlog.file.reader import read_log
from flightlog.motion.continuity import with_marked_holes
from maneuver.options.films import FILM_ENDING, STILL_ENDING, make_film, make_still
from maneuver.options.numbers import Count
from maneuver.report.flight_report import campaign_report, flight_report, side_by_side, summary_content
from review.page.campaign_page import campaign_page
from review.page.campaign_rows import FlightRow, flight_row, sort_outliers_first
from review.page.page import ReviewedFlight, review_page
from review.pictures.flight_picture import picture_paths, write_pictures
from review.summary.bound_check import with_bounds_of
from review.summary.control_limits import control_limits
from review.summary.summary import summarise
from runtime.atomic_write import check_output_files, write_atomically
from runtime.executor import default_workers, worker_pool
from runtime.progress import show_progress
from scenarios.find import find_library

MOST_COMPARED = 4
FAILED = 1


@dataclass(frozen=True, slots=True)
class _ReviewOptions:
    """Outputs of a review."""

    html: bool
    png: bool
    out: Path
    video: Path | None
    still: Path | None
    at: float
    force: bool
    json: bool
    library: Library | None

    def page(self, name: str) -> Path:
        """Returns where a page goes."""
        return self.out / f"{name}.html"


def review(
    logs: Annotated[tuple[Path, ...], Parameter(negative="")],
    /,
    *,
    html: Annotated[bool, Parameter(negative="")] = False,
    png: Annotated[bool, Parameter(negative="")] = False,
    out: Path | None = None,
    pages: NonNegativeInt = 10,
    library: str | None = None,
    video: Path | None = None,
    still: Path | None = None,
    at: float = 0.0,
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Reviews one log, several side by side, or a folder of them.

    Prints a summary. A page is one self-contained file for a browser and needs no network. Several logs are
    overlaid, aligned at their starts. A folder's page lists its flights, outliers first, and the first ones
    get a page each; the exit code is then 1 if a flight was lost, missed its goal or cannot be reviewed.

    For example:

        maneuver review flight.mcap

        maneuver review flight.mcap --html --png

        maneuver review nominal.mcap worst-case.mcap --html

        maneuver review flights --html --pages 5 --library gtmax-sim

        maneuver review flight.mcap --video chase.mp4

        maneuver review flight.mcap --still chase.png --at 9

    Args:
        logs: a flight log, up to four to compare, or a folder of logs.
        html: write a page.
        png: write pictures of a single log.
        out: folder for the page and pictures; the first LOG's name with -review by default.
        pages: number of flights of a folder that get a page each.
        library: library whose errors are the bounds, name or path; by default the one that the flights were
            flown with. Campaign flights are compared with no bounds unless it is given: they are flown to
            find the bounds.
        video: film of a single flight from a chase camera, FILE.mp4.
        still: single picture of that film, FILE.png.
        at: time of that picture, seconds into the flight.
        workers: number of processes for a folder; one per processor by default.
        force: overwrite files of the same name.
        json: print the summary as JSON.
    """
    order = _ReviewOptions(
        html=html,
        png=png,
        out=out or Path(f"{logs[0].resolve().stem}-review"),
        video=video,
        still=still,
        at=at,
        force=force,
        json=json,
        library=find_library(library) if library is not None else None,
    )
    if out is not None and not (html or png):
        raise FlightError("--out: expected --html or --png, got neither")
    folders = [path for path in logs if path.is_dir()]
    if (png or video or still) and (folders or len(logs) > 1):
        raise FlightError(
            "--png, --video and --still: expected a single log, got several; --html shows several"
        )
    if folders and len(logs) > 1:
        raise FlightError(f"expected logs or one folder, got {len(logs)} paths with the folder {folders[0]}")
    if len(logs) > MOST_COMPARED:
        raise FlightError(f"expected at most {MOST_COMPARED} logs to compare, got {len(logs)}; give a folder")
    if folders:
        return _review_folder(folders[0], order, pages, workers or default_workers())
    return _review_flights(logs, order)


def _review_flights(logs: tuple[Path, ...], order: _ReviewOptions) -> int:
    names = _labels(logs)
    flights = [_review_log(path, name, order.library) for path, name in zip(logs, names, strict=True)]
    files: list[Path] = []
    page = order.page("-and-".join(names)) if order.html else None
    drawn = picture_paths(flights[0].log, order.out) if order.png else ()
    check_output_files(order.video, force=order.force, ending=FILM_ENDING)
    check_output_files(order.still, force=order.force, ending=STILL_ENDING)
    check_output_files(page, *drawn, order.video, order.still, force=order.force, inputs=logs)
    if order.png:
        log = flights[0].log
        files += write_pictures(log, order.out, limits=control_limits(log), force=order.force)
    if page is not None:
        _publish_page(flights, page, force=order.force)
        files.insert(0, page)
    if order.video is not None:
        make_film(flights[0].log, order.video, force=order.force)
        files.append(order.video)
    if order.still is not None:
        make_still(flights[0].log, order.still, time=order.at, force=order.force)
        files.append(order.still)
    summaries = [part.summary for part in flights]
    if order.json:
        contents = [summary_content(summary) for summary in summaries]
        what = contents[0] if len(logs) == 1 else {"flights": contents}
        print(json_module.dumps({**what, "files": [str(path) for path in files]}))
        return 0
    console = Console(highlight=False)
    console.print(flight_report(summaries[0]) if len(logs) == 1 else side_by_side(names, summaries))
    _print_files(files)
    return 0


def _review_folder(folder: Path, order: _ReviewOptions, pages: int, workers: int) -> int:
    paths = sorted(folder.rglob("*.mcap"))
    if not paths:
        raise FlightError(f"{folder}: expected flight logs (*.mcap), got none")
    page = order.page("index") if order.html else None
    check_output_files(page, force=order.force)
    files: list[Path] = []
    with worker_pool(min(workers, len(paths))) as executor:
        judged = partial(flight_row, library=order.library)
        rows = sort_outliers_first(
            list(show_progress(executor.map(judged, paths), total=len(paths), what="reviewing"))
        )
        if page is not None:
            chosen = [row.path for row in rows if not row.problem][:pages]
            addresses = {path: order.page(_name_in(folder, path)) for path in chosen}
            check_output_files(page, *addresses.values(), force=order.force)
            write = partial(_write_page, library=order.library, force=order.force)
            made = executor.map(write, addresses.keys(), addresses.values())
            files = list(show_progress(made, total=len(chosen), what="pages"))
            links = {path: made.name for path, made in addresses.items()}
            content = campaign_page(rows, title=folder.resolve().name, pages=links)
            write_atomically(content.encode(), page, force=order.force)
            files.insert(0, page)
    if order.json:
        content_json = {
            "flights": [_row_content(row) for row in rows],
            "files": [str(path) for path in files],
        }
        print(json_module.dumps(content_json))
    else:
        Console(highlight=False).print(campaign_report(rows))
        _print_files(files[:1])
    return 0 if all(row.good for row in rows) else FAILED


def _review_log(path: Path, label: str, library: Library | None) -> ReviewedFlight:
    log = with_marked_holes(read_log(path))
    if library is not None:
        log = with_bounds_of(log, library)
    return ReviewedFlight(log, summarise(log), label)


def _labels(logs: tuple[Path, ...]) -> list[str]:
    """Returns labels of the logs: stems, with folders where those are equal."""
    stems = [path.stem for path in logs]
    if len(set(stems)) == len(stems):
        return stems
    return [f"{place}-{path.resolve().parent.name}-{path.stem}" for place, path in enumerate(logs, start=1)]


def _name_in(folder: Path, path: Path) -> str:
    return "-".join(path.relative_to(folder).with_suffix("").parts)


def _write_page(log: Path, page: Path, *, library: Library | None, force: bool) -> Path:
    _publish_page([_review_log(log, log.stem, library)], page, force=force)
    return page


def _publish_page(flights: list[ReviewedFlight], page: Path, *, force: bool) -> None:
    content = review_page(flights, limits=control_limits(flights[0].log))
    write_atomically(content.encode(), page, force=force)


def _row_content(row: FlightRow) -> dict[str, object]:
    """Returns a row as JSON values; null where a score is unbounded."""
    content = asdict(row)
    score = row.score if row.score < float("inf") else None
    return {**content, "path": str(row.path), "figures": dict(row.figures), "score": score}


def _print_files(files: list[Path]) -> None:
    if files:
        others = ", ".join(path.name for path in files[1:])
        print(f"\nfiles  {files[0]}{f', {others}' if others else ''}")
