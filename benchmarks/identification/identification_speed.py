"""Identification speed: `python -m benchmarks.identification.identification_speed FOLDER_OF_LOGS`.

CPU seconds of one core, including reading, checking and hashing the files. Half and a quarter of the logs
show whether the cost is linear in flight hours.
"""

from argparse import ArgumentParser
from pathlib import Path
from time import process_time

from experiments.campaign.coverage_report import split_by_kind
from experiments.campaign.evidence import evidence_of
from identification.identify import identify


def main() -> None:
    """Prints flight time over CPU time, and cost per flight hour."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    paths = sorted(parser.parse_args().folder.glob("*.mcap"))
    # Imports, protobuf classes and caches are paid once.
    measured(paths[:1])
    whole = 0.0
    for share in (1, 2, 4):
        flown, cutting, building = measured(paths[::share])
        cost = (cutting + building) / flown * 3600
        whole = whole or cost
        print(
            f"{len(paths[::share]):4d} logs, {flown / 3600:6.2f} h: cut {cutting:6.2f} s, library "
            f"{building:6.2f} s, {flown / (cutting + building):6.0f} x real time, "
            f"cost an hour {cost / whole:5.2f} of that of all"
        )


def measured(paths: list[Path]) -> tuple[float, float, float]:
    """Returns flight seconds, and CPU seconds of segmentation and of identification."""
    began = process_time()
    flights = [evidence_of(path) for path in paths]
    cut = process_time()
    bounding, centring = split_by_kind(flights)
    identify(bounding or centring, nominal=centring if bounding else (), name="speed")
    return sum(flight.duration for flight in flights), cut - began, process_time() - cut


if __name__ == "__main__":
    main()
