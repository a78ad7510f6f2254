"""`maneuver library interpolate`: primitives that were never flown, interpolated between those that were."""

import sys
from math import inf
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from flight.automaton.library_file import library_hash, library_text
from flight.errors import FlightError
from flight.plural import plural
from flight.units import FOOT
from identification.data_sheet import describe_claim
from identification.interpolation.interpolate import interpolate_library as grow_library
from scenarios.find import find_library, library_path

from .publish import check_library_target, publish_library


def interpolate(
    library: str,
    /,
    *,
    out: Path,
    speed_step: float = 4 * FOOT,
    rate_step: float = 0.1,
    coverage: float = 0.95,
    confidence: float = 0.95,
    name: str | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Interpolates trims and maneuvers on a grid inside the flown range.

    The errors of what was never flown are interpolated, and inflated by a factor at which the flown
    primitives, each left out in turn, would have had every flown sample inside the bounds that the others
    give: as many of them as it takes to claim COVERAGE with CONFIDENCE, or all, and then less is claimed. The
    claim is of the kind: so large a share of the grown primitives holds as many flights as each flown one
    had. A flown trim that grown maneuvers lead to is widened and claims what grown ones do; flown maneuvers
    stay as they are. `maneuver library test` flies a random sample against the claim.

    For example:

        maneuver library interpolate trends-flown.json --out grown.json

    Args:
        library: flown, name or path.
        out: where the grown library goes; its data sheet goes beside it.
        speed_step: of the grid, m/s.
        rate_step: of the grid, rad/s.
        coverage: share of the grown primitives that are to hold as many flights as were flown.
        confidence: of that share.
        name: of the interpolated library; OUT's by default.
        force: overwrite OUT.
        json: print the library as JSON.
    """
    for option, share in (("--coverage", coverage), ("--confidence", confidence)):
        if not 0 < share < 1:
            raise FlightError(f"{option} must be between 0 and 1, got {share}")
    for option, step in (("--speed-step", speed_step), ("--rate-step", rate_step)):
        if not 0 < step < inf:
            raise FlightError(f"{option} must be > 0, got {step}")
    check_library_target(out, force=force, inputs=[library_path(library)])
    grown = grow_library(
        find_library(library),
        speed_step=speed_step,
        yaw_rate_step=rate_step,
        name=name or out.stem,
        coverage=coverage,
        confidence=confidence,
    )
    publish_library(grown.library, out, force=force)
    if json:
        sys.stdout.write(library_text(grown.library))
        return 0
    print(
        f"{plural(len(grown.library.trims), 'trim')}, {grown.trims} of them interpolated; "
        f"{plural(len(grown.library.maneuvers), 'maneuver')}, {grown.maneuvers} of them interpolated"
    )
    for kind, claim in (("trims", grown.trim_claim), ("maneuvers", grown.maneuver_claim)):
        print(f"interpolated {kind}: {describe_claim(claim)}")
    for fit in grown.fits:
        print(
            f"{fit.number:24s} off by {fit.cross_validation_error:.4f} where left out, "
            f"smoothing {fit.smoothing:g}"
        )
    print(f"library    {out}\ndata sheet {out.with_suffix('.md')}\nsha256     {library_hash(grown.library)}")
    return 0
