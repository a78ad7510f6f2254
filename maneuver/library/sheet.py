"""`maneuver library sheet`: data sheet of a library with pictures."""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiments.campaign.evidence import log_paths
from experiments.thesis.error_ratios import ErrorRatio, error_ratios, is_comparable
from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.errors import FlightError
from flight.units import FOOT
from flightlog.file.reader import read_log
from identification.data_sheet import data_sheet
from identification.segmentation.observations import Observations, merge_observations, observations
from identification.segmentation.segmentation import segment
from maneuver.options.numbers import Count
from review.pictures.flight_picture import write_picture
from review.pictures.library_picture import graph_picture, library_picture
from review.pictures.repeatability_picture import deviations_picture, repeatability_picture
from runtime.atomic_write import check_output_folder, write_atomically
from runtime.executor import default_workers, worker_pool
from runtime.progress import show_progress
from scenarios.find import find_library

THESIS = "thesis-gtmax"


def sheet(
    library: str,
    /,
    *,
    out: Path,
    logs: Annotated[list[Path] | None, Parameter(negative="")] = None,
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Writes a library's data sheet into a folder: `sheet.md` with its pictures.

    It holds the graph, every number with its error and the flights used; for a library with the thesis's
    trims also Tables 9 and 10. With --logs, the logs that it was identified from, it also holds every
    performance of every maneuver overlaid (Figure 6), and the deviations with the bounds.

    For example:

        maneuver library sheet gtmax-sim --out gtmax-sim-sheet

        maneuver library sheet mine.json --logs flights --out mine-sheet

    Args:
        library: name or path of the library.
        out: folder for the data sheet.
        logs: flight logs, or folders of them.
        workers: number of processes that read logs; one per processor by default.
        force: overwrite files in OUT.
    """
    found = find_library(library)
    check_output_folder(out, force=force)
    paths = log_paths(logs) if logs else []
    seen = None
    if paths:
        with worker_pool(workers or default_workers()) as executor:
            reading = executor.map(_observations_of, paths)
            seen = merge_observations(show_progress(reading, total=len(paths), what="reading"))
        _check_same_automaton(found, seen)
    pictures = {"graph.png": graph_picture(found), "numbers.png": library_picture(found)}
    if seen is not None:
        pictures["repeatability.png"] = repeatability_picture(found, seen.tracks)
        pictures["deviations.png"] = deviations_picture(found, seen.trims, seen.maneuvers)
    for name, figure in pictures.items():
        write_picture(figure, out / name, force=force)
    text = "\n".join(_parts(found, seen is not None)) + "\n"
    write_atomically(text.encode(), out / "sheet.md", force=force)
    print(f"data sheet {out / 'sheet.md'}, {len(pictures)} pictures")
    return 0


def _observations_of(path: Path) -> Observations:
    log = read_log(path)
    try:
        return observations(log, segment(log), log.library())
    except FlightError as error:
        raise FlightError(f"{path}: {error}") from None


def _check_same_automaton(library: Library, seen: Observations) -> None:
    known = {row.id for row in library.maneuvers}
    if not set(seen.tracks) <= known:
        unknown = sorted(set(seen.tracks) - known)
        raise FlightError(
            f"--logs: expected maneuvers of {library.name}, got logs with other maneuvers {unknown}"
        )


def _parts(library: Library, observed: bool) -> Iterator[str]:
    yield data_sheet(library)
    yield f"sha256 of the library: `{library_hash(library)}`.\n"
    yield "## Graph\n\n![Trims by yaw rate and forward speed, maneuvers as arrows](graph.png)\n"
    yield "![Every number with its signed error](numbers.png)\n"
    if observed:
        yield "## Repeatability\n\n![All performances, relative to their entry](repeatability.png)\n"
        yield "## Deviations and bounds\n\n![Histograms of all deviations, with the bounds](deviations.png)\n"
        yield "Nominal flights among the logs gave the values, not the bounds, and may lie outside them.\n"
    printed = find_library(THESIS)
    if library.name != THESIS and is_comparable(library, printed):
        yield from _comparison_with_thesis(list(error_ratios(library, printed)))
    flown = library.provenance.get("logs_by_seed")
    if isinstance(flown, dict) and flown:
        yield f"## Flights used\n\n{len(flown)} flights, by seed, with the sha256 of their logs:\n"
        yield "| seed | sha256 |\n| --- | --- |"
        yield from (f"| {seed} | `{digest}` |" for seed, digest in flown.items())


_UNITS = {
    ("trim", "forward"): "ft/s",
    ("trim", "side"): "ft/s",
    ("trim", "yaw_rate"): "rad/s",
    ("maneuver", "duration"): "s",
    ("maneuver", "forward"): "ft",
    ("maneuver", "side"): "ft",
    ("maneuver", "heading_change"): "rad",
}


def _comparison_with_thesis(rows: list[ErrorRatio]) -> Iterator[str]:
    near = sum(row.same_order for row in rows)
    yield "## Comparison with Tables 9 and 10 of the thesis\n"
    yield (
        f"Absolute errors in the units of the tables. {near} of {len(rows)} are of the same order "
        "(ratio 1/4 to 4); the last column explains the others.\n"
    )
    yield "| error | unit | library | thesis | ratio | reason |\n| --- | --- | --- | --- | --- | --- |"
    for row in rows:
        unit = _UNITS[row.kind, row.name]
        scale = FOOT if unit.startswith("ft") else 1.0
        name = row.name.replace("_", " ")
        numbers = f"{row.ours / scale:.3f} | {row.printed / scale:.3f} | {row.ratio:.2f}"
        yield f"| {row.kind} {row.id} {name} | {unit} | {numbers} | {row.why} |"
    yield ""
