"""`maneuver library graph`: the automaton as a picture (thesis, Figures 3 and 4)."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from review.pictures.flight_picture import write_picture
from review.pictures.library_picture import graph_picture, library_picture
from runtime.atomic_write import check_output_files
from scenarios.find import find_library, library_path


def graph(
    library: str,
    /,
    *,
    out: Path | None = None,
    numbers: Annotated[bool, Parameter(negative="")] = False,
    force: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Draws the automaton: trims by yaw rate and speed, maneuvers as arrows.

    For example:

        maneuver library graph thesis-gtmax

        maneuver library graph gtmax-sim --numbers --out gtmax-sim.png

    Args:
        library: name or path of the library.
        out: picture to write; NAME-graph.png by default.
        numbers: also list every number with its signed error.
        force: overwrite OUT.
    """
    found = find_library(library)
    path = out or Path(f"{found.name}-graph.png")
    check_output_files(path, force=force, inputs=[library_path(library)], ending=".png")
    write_picture(library_picture(found) if numbers else graph_picture(found), path, force=force)
    print(f"picture {path}")
    return 0
