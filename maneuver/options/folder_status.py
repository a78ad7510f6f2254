"""Status of a folder of jobs: `--status`."""

import json
from collections.abc import Sequence

from runtime.job import JobState
from runtime.job_store import JobStoreStatus, Result

INCOMPLETE = 1
# Names that are listed before the rest is counted.
_NAMED = 5


def print_status(seen: JobStoreStatus[Result], *, as_json: bool) -> int:
    """Prints a folder's status; returns 0 if nothing is missing."""
    listed = {
        "complete": seen.paths(JobState.WHOLE),
        "missing": seen.paths(JobState.MISSING),
        "damaged": seen.paths(JobState.DAMAGED),
        "other flights": seen.paths(JobState.ANOTHER),
        "unrelated files": seen.foreign_files,
        "partial files": seen.partial_files,
    }
    if as_json:
        names = {key.replace(" ", "_"): [path.name for path in paths] for key, paths in listed.items()}
        print(json.dumps({"folder": str(seen.folder), "flights": len(seen.jobs), **names}))
    else:
        print(f"{'folder':<20} {seen.folder}")
        print(f"{'flights':<20} {len(seen.jobs)}")
        for words, paths in listed.items():
            named = "" if words == "complete" else _list_names([path.name for path in paths])
            print(f"{words:<20} {len(paths)}{named}")
        for found in seen.status:
            if found.reason:
                print(found.reason)
    return 0 if seen.complete else INCOMPLETE


def _list_names(names: Sequence[str]) -> str:
    if not names:
        return ""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ": " + ", ".join(names[:_NAMED]) + more
