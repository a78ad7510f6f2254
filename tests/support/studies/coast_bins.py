"""Share of maneuvers outside their bounds, by the coast before them.

`python -m tests.support.studies.coast_bins LIBRARY LOG_FOLDER`: maneuvers of mission logs against the
library's constant bounds and, where it has them, against the bounds about the mean for their entry.
"""

import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from experiments.campaign.evidence import evidence_of
from flight.automaton.library import Library
from identification.coverage_trial import is_inside, maneuver_box
from identification.segmentation.flight_evidence import FlightEvidence
from identification.statistics.samples import maneuver_row
from scenarios.find import find_library

BINS = ((0.0, "0 s"), (0.5, "to 0.5 s"), (1.0, "to 1 s"), (2.0, "to 2 s"), (np.inf, "over 2 s"))


def bin_of(coast: float) -> str:
    """Returns the bin of a coast in seconds."""
    return next(name for longest, name in BINS if coast <= longest + 1e-6)


def shares_outside(library: Library, flights: Iterable[FlightEvidence]) -> dict[str, tuple[int, int, int]]:
    """Returns by bin: maneuvers, outside constant bounds, outside those for the entry."""
    found = {name: [0, 0, 0] for _, name in BINS}
    by_id = {row.id: row for row in library.maneuvers}
    for flight in flights:
        for part in flight.segments.maneuvers:
            if not part.settled:
                continue
            row, values = by_id[part.id], np.array([maneuver_row(part)])
            counts = found[bin_of(part.coast)]
            counts[0] += 1
            counts[1] += not maneuver_box(row).contains(values, values)[0]
            counts[2] += not is_inside(library, row, part)
    return {name: (count, plain, entered) for name, (count, plain, entered) in found.items()}


def main() -> None:
    """Prints the table."""
    library, folder = find_library(sys.argv[1]), Path(sys.argv[2])
    found = shares_outside(library, map(evidence_of, sorted(folder.glob("*.mcap"))))
    total = tuple(sum(row[place] for row in found.values()) for place in range(3))
    print("coast before   maneuvers  outside constant  outside by entry")
    for name, (count, plain, entered) in [*found.items(), ("all", total)]:
        shares = [f"{100 * number / count:6.1f} %" if count else "       -" for number in (plain, entered)]
        print(f"{name:14} {count:9d}  {shares[0]:>16}  {shares[1]:>16}")


if __name__ == "__main__":
    main()
