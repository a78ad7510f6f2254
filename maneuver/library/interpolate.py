"""`maneuver library interpolate`: interpolation of primitives between flown ones."""

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
from identification.interpolation.interpolate import interpolate_library
from scenarios.find import find_library, library_path

from .library_files import check_library_target, write_library_files


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

    Interpolated errors are inflated by a factor from leave-one-out cross-validation: with it, bounds
    interpolated from the other primitives contain every sample of each left-out one, for as many primitives
    as --coverage with --confidence requires. If that is more than there are, the claim is weaker. It reads:
    this share of the interpolated primitives contains as many flights as each flown primitive had. Flown
    trims that interpolated maneuvers lead to are widened and get the same claim; flown maneuvers are
    unchanged. `maneuver library test` tests the claim with new flights of a random sample.

    For example:

        maneuver library interpolate trends-flown.json --out interpolated.json

    Args:
        library: name or path of the flown library.
        out: interpolated library to write; its data sheet is written beside it.
        speed_step: speed step of the grid, m/s.
        rate_step: yaw-rate step of the grid, rad/s.
        coverage: share of the interpolated primitives whose bounds contain all flights.
        confidence: confidence of that share.
        name: name of the interpolated library; OUT's by default.
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
    result = interpolate_library(
        find_library(library),
        speed_step=speed_step,
        yaw_rate_step=rate_step,
        name=name or out.stem,
        coverage=coverage,
        confidence=confidence,
    )
    write_library_files(result.library, out, force=force)
    if json:
        sys.stdout.write(library_text(result.library))
        return 0
    print(
        f"{plural(len(result.library.trims), 'trim')}, {result.trims} of them interpolated; "
        f"{plural(len(result.library.maneuvers), 'maneuver')}, {result.maneuvers} of them interpolated"
    )
    for kind, claim in (("trims", result.trim_claim), ("maneuvers", result.maneuver_claim)):
        print(f"interpolated {kind}: {describe_claim(claim)}")
    for fit in result.fits:
        print(
            f"{fit.number:24s} cross-validation error {fit.cross_validation_error:.4f}, "
            f"smoothing {fit.smoothing:g}"
        )
    print(f"library    {out}\ndata sheet {out.with_suffix('.md')}\nsha256     {library_hash(result.library)}")
    return 0
