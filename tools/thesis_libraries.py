"""Writer of the thesis's libraries and the schema of all: `python -m tools.thesis_libraries`."""

import json

import libraries
from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library_file import library_json_schema, library_text
from identification.data_sheet import data_sheet


def main() -> None:
    """Writes the thesis's libraries with data sheets, and the JSON Schema."""
    for library in (thesis_kinematic(), thesis_gtmax()):
        path = libraries.FOLDER / f"{library.name}.json"
        path.write_text(library_text(library), encoding="utf-8")
        path.with_suffix(".md").write_text(data_sheet(library), encoding="utf-8")
    schema = libraries.FOLDER / "library.schema.json"
    schema.write_text(json.dumps(library_json_schema(), indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
