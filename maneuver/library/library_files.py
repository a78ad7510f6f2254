"""Files of a library: the library and its data sheet."""

from collections.abc import Iterable
from pathlib import Path

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash, library_text
from flight.plural import plural
from identification.data_sheet import data_sheet
from runtime.atomic_write import check_output_files, file_target, remove_partial_files, write_unless_equal


def check_library_target(path: Path, *, force: bool, inputs: Iterable[Path] = ()) -> None:
    """Checks that a library and its data sheet can be written.

    Raises:
        FlightError: as `check_output_files`.
    """
    # A path without a name has no data sheet.
    file_target(path, force=force)
    check_output_files(path, path.with_suffix(".md"), force=force, inputs=inputs)


def write_library_files(library: Library, path: Path, *, force: bool) -> None:
    """Writes a library and its data sheet atomically."""
    sheet = path.with_suffix(".md")
    for target, text in ((path, library_text(library)), (sheet, data_sheet(library))):
        remove_partial_files(target.parent, of=target.name)
        write_unless_equal(text.encode(), target, force=force)


def library_report(library: Library, path: Path) -> str:
    """Returns the report of a new library."""
    statistics = [trim.statistics for trim in library.trims]
    statistics += [maneuver.statistics for maneuver in library.maneuvers]
    known = [entry for entry in statistics if entry is not None]
    samples = sorted({entry.samples for entry in known})
    least, most = samples[0], samples[-1]
    flights = plural(least, "flight") if least == most else f"{least}-{most} flights"
    return (
        f"{plural(len(library.trims), 'trim')}, {plural(len(library.maneuvers), 'maneuver')}, "
        f"{flights} each, {plural(sum(entry.timeouts for entry in known), 'time-out')}\n"
        f"claim      {min(entry.coverage for entry in known):.1%} of {library.conditions.future_flights} "
        f"inside all bounds of a "
        f"primitive at once, with {known[0].confidence:.0%} confidence\n"
        f"library    {path}\n"
        f"data sheet {path.with_suffix('.md')}\n"
        f"sha256     {library_hash(library)}\n"
    )
