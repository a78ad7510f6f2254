"""`maneuver thesis`: figures printed in the thesis, beside computed ones."""

import json as json_module
import sys
from dataclasses import asdict
from typing import Annotated

from cyclopts import Parameter

from experiments.thesis.closed_loop_tables import NOT_REPRODUCED, compare_closed_loops
from experiments.thesis.cost_tables import PRINTED, compare_cost, compare_examples, compare_sequence_counts
from maneuver.report.thesis_report import markdown_page, print_thesis_tables
from scenarios.find import find_library

DIFFERS = 1
"""Exit code if a figure differs without explanation."""


def thesis(
    *,
    closed_loop: bool = True,
    markdown: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Prints the thesis's figures beside computed ones, with differences marked.

    Tables 11 to 18 are reproduced except for one figure. Tables 19 to 26 cannot be reproduced; the reason is
    printed. Problems 4.3 and 4.4 (numbered 4) and Tables 27 to 33 of appendix B follow, misprints marked. The
    closed-loop columns of Tables 12 to 26 are flown by the library's model with the library's errors, which
    takes some seconds. The exit code is 1 if a figure differs without an explanation.

    For example:

        maneuver thesis

        maneuver thesis --markdown

        maneuver thesis --json

    Args:
        closed_loop: also fly the closed-loop figures.
        markdown: print Markdown.
        json: print one JSON document.
    """
    rows = [
        *compare_sequence_counts(find_library("thesis-gtmax")),
        *map(compare_cost, PRINTED),
        *compare_examples(),
    ]
    flights = list(compare_closed_loops()) if closed_loop else []
    if json:
        document = {
            "comparisons": [asdict(row) for row in rows],
            "closed_loop": [asdict(row) for row in flights],
            "not_compared": NOT_REPRODUCED,
        }
        sys.stdout.write(json_module.dumps(document, indent=2) + "\n")
    elif markdown:
        sys.stdout.write(markdown_page(rows, flights))
    else:
        print_thesis_tables(rows, flights)
    return DIFFERS if any(row.verdict == "differs" for row in rows) else 0
