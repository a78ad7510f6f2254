"""Whether grown primitives keep their bounds: `python -m benchmarks.grown_library grown.json 30 8 1`.

So many pairs of trims that a grown maneuver joins, drawn by chance, are flown there and back in so many
flights each, with seeds that no identification has seen. Printed is the share of performances and of coasts
that are inside all bounds at once, of grown primitives and of flown ones, and how many keep 95 %.
"""

import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

from flight.library import Library
from flight.library_file import read_library
from flight.se2 import SE2
from flight.sequence import Sequence
from identification.segmentation import CoastSegment, ManeuverSegment, segment
from sim.campaign import fly_specification
from sim.specification import specify_sequence

COAST = 4.0
Kept = defaultdict[tuple[str, int], list[bool]]


def main(path: Path, pairs: int, flights: int, seed: int) -> int:
    """Prints the shares; returns the grown primitives that keep less than 95 %."""
    library = read_library(path)
    rng = np.random.default_rng(seed)
    grown = [row for row in library.maneuvers if row.statistics is None]
    edges = {(row.from_trim, row.to_trim) for row in library.maneuvers}
    there_and_back = [row for row in grown if (row.to_trim, row.from_trim) in edges]
    chosen = [there_and_back[place] for place in rng.choice(len(there_and_back), pairs, replace=False)]
    kept: Kept = defaultdict(list)
    for row in chosen:
        for flight in range(flights):
            walk = (row.from_trim, row.to_trim, row.from_trim, row.to_trim)
            heading = float(rng.uniform(-np.pi, np.pi))
            sequence = Sequence(
                f"grown-{row.id}-{flight}",
                SE2(0.0, 0.0, heading),
                walk,
                (COAST,) * 4,
                library.conditions.wind,
            )
            altitude = library.conditions.altitude or 30.0
            order = specify_sequence(sequence, seed=int(rng.integers(2**62)), altitude=altitude)
            segments = segment(fly_specification(order, library))
            for maneuver in segments.maneuvers:
                kept["maneuver", maneuver.id].append(_performed_inside(library, maneuver))
            for coast in segments.coasts:
                kept["trim", coast.trim].append(_held_inside(library, coast))
    return _report(library, kept)


def _performed_inside(library: Library, flown: ManeuverSegment) -> bool:
    row = next(row for row in library.maneuvers if row.id == flown.id)
    moved, error = row.displacement, row.error
    return flown.settled and all(
        abs(value - nominal) <= abs(bound)
        for value, nominal, bound in (
            (flown.duration, row.duration, error.duration),
            (flown.displacement.x, moved.x, error.forward),
            (flown.displacement.y, moved.y, error.side),
            (flown.displacement.heading, moved.heading, error.heading_change),
        )
    )


def _held_inside(library: Library, coast: CoastSegment) -> bool:
    trim = library.trim(coast.trim)
    centre = (trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate)
    bound = np.abs((trim.error.forward, trim.error.side, trim.error.yaw_rate))
    return bool((np.abs(coast.velocity - centre) <= bound).all())


def _report(library: Library, kept: Kept) -> int:
    flown = {("trim", trim.id) for trim in library.trims if trim.statistics}
    flown |= {("maneuver", row.id) for row in library.maneuvers if row.statistics}
    broken = 0
    for kind in ("trim", "maneuver"):
        for words, is_flown in (("grown", False), ("flown", True)):
            rows = [each for key, each in kept.items() if key[0] == kind and (key in flown) == is_flown]
            if not rows:
                continue
            shares = [float(np.mean(each)) for each in rows]
            inside, total = sum(map(sum, rows)), sum(map(len, rows))
            keeping = sum(share >= 0.95 for share in shares)
            broken += 0 if is_flown else len(rows) - keeping
            print(
                f"{words} {kind}s: {inside} of {total} samples inside ({100 * inside / total:.1f} %); "
                f"{keeping} of {len(rows)} keep 95 %, the worst keeps {100 * min(shares):.0f} %"
            )
    return broken


if __name__ == "__main__":
    numbers = [int(one) for one in sys.argv[2:]]
    sys.exit(1 if main(Path(sys.argv[1]), *(numbers + [30, 8, 1][len(numbers) :])) else 0)
