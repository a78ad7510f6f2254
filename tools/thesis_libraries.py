"""Writer of the shipped libraries of the thesis: `python -m tools.thesis_libraries`."""

import libraries
from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library_file import library_text
from identification.data_sheet import data_sheet


def main() -> None:
    """Writes both libraries into `libraries/`, each with its data sheet."""
    for library in (thesis_kinematic(), thesis_gtmax()):
        path = libraries.FOLDER / f"{library.name}.json"
        path.write_text(library_text(library), encoding="utf-8")
        path.with_suffix(".md").write_text(data_sheet(library), encoding="utf-8")


if __name__ == "__main__":
    main()
