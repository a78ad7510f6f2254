"""What a folder holds of some work, in words: `--status`."""

import json
from collections.abc import Sequence

from runtime.job import State
from runtime.job_store import Result, Survey

INCOMPLETE = 1
# Names that are listed before the rest is counted.
_NAMED = 5


def show_status(seen: Survey[Result], *, as_json: bool) -> int:
    """Prints what is there, and returns the exit code: 0 where nothing is missing."""
    listed = {
        "whole": seen.paths(State.WHOLE),
        "missing": seen.paths(State.MISSING),
        "damaged": seen.paths(State.DAMAGED),
        "of another flight": seen.paths(State.ANOTHER),
        "not of this command": seen.strangers,
        "left half-written": seen.partial,
    }
    if as_json:
        names = {key.replace(" ", "_"): [path.name for path in paths] for key, paths in listed.items()}
        print(json.dumps({"folder": str(seen.folder), "flights": len(seen.works), **names}))
    else:
        print(f"{'folder':<20} {seen.folder}")
        print(f"{'flights':<20} {len(seen.works)}")
        for words, paths in listed.items():
            named = "" if words == "whole" else _named([path.name for path in paths])
            print(f"{words:<20} {len(paths)}{named}")
        for found in seen.found:
            if found.why:
                print(found.why)
    return 0 if seen.complete else INCOMPLETE


def _named(names: Sequence[str]) -> str:
    if not names:
        return ""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ": " + ", ".join(names[:_NAMED]) + more
