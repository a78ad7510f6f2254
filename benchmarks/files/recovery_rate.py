"""Recovery rate of damaged logs by `maneuver recover`.

For example:

    python -m benchmarks.files.recovery_rate --logs flights --truncations 1000
"""

import argparse
import random
from collections import Counter
from pathlib import Path

from benchmarks.upper_limit import upper_limit
from flightlog.file.recovery import Salvage, contains_salvage, recovered_bytes, salvage


def main() -> None:
    """Prints recovery counts of randomly cut logs, half with a flipped bit."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--logs", type=Path, required=True, help="a folder of MCAP files, of any writer")
    parser.add_argument("--truncations", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    chance, outcomes = random.Random(arguments.seed), Counter[str]()
    contents = [path.read_bytes() for path in sorted(arguments.logs.glob("*.mcap"))]
    wholes = [salvage(content) for content in contents]
    for number in range(arguments.truncations):
        place = number % len(contents)
        damaged = bytearray(contents[place][: chance.randrange(len(contents[place]))])
        if number % 2 and damaged:
            damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
        outcomes[_outcome(salvage(bytes(damaged)), wholes[place])] += 1
    for outcome, count in outcomes.most_common():
        print(f"{count:6d} of {arguments.truncations} {outcome}")
    wrong = sum(count for outcome, count in outcomes.items() if outcome.startswith("wrong"))
    upper = upper_limit(wrong, arguments.truncations)
    print(f"{wrong:6d} of {arguments.truncations} wrong; 95 % upper limit {100 * upper:.2f} %")


def _outcome(found: Salvage, whole: Salvage) -> str:
    if not found.messages:
        return "with nothing to save"
    if not contains_salvage(recovered_bytes(found), found):
        return "wrong: unreadable"
    true = {(message.channel_id, message.log_time, message.data) for message in whole.messages}
    if any((message.channel_id, message.log_time, message.data) not in true for message in found.messages):
        return "wrong: messages that were never logged"
    if found.lossless and len(found.messages) != len(whole.messages):
        return "wrong: called lossless"
    return "without loss" if found.lossless else "with loss, whole chunks kept"


if __name__ == "__main__":
    main()
