"""Latitudes and longitudes in a local plane."""

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flightlog.imports.measured_motion import Source

Column = Float[np.ndarray, "n"]

_EARTH_RADIUS = 6_371_000.0


def local_plane(
    time: Column, latitude: Column, longitude: Column, height: Column | None
) -> tuple[Source, str]:
    """Returns positions relative to the first, and the plane in words.

    Heights are above the first one, along the ellipsoid's normals, not above the plane.

    Args:
        time: seconds.
        latitude: degrees north, WGS 84.
        longitude: degrees east, WGS 84.
        height: metres; None if not known.

    Raises:
        FlightError: these are no latitudes and longitudes, or pymap3d is not installed.
    """
    try:
        from pymap3d import geodetic2ned
    except ImportError:
        raise FlightError("latitudes and longitudes need the package pymap3d: pip install pymap3d") from None
    known = np.isfinite(latitude) & np.isfinite(longitude) & ((latitude != 0.0) | (longitude != 0.0))
    if height is not None:
        known &= np.isfinite(height)
    if not known.any():
        raise FlightError("expected latitudes and longitudes, got none")
    if np.abs(latitude[known]).max() > 90.0 or np.abs(longitude[known]).max() > 360.0:
        raise FlightError(
            f"expected latitudes within 90 and longitudes within 360 degrees, got "
            f"{np.abs(latitude[known]).max():g} and {np.abs(longitude[known]).max():g}"
        )
    lat, lon = latitude[known], longitude[known]
    up = height[known] if height is not None else np.zeros(len(lat))
    north, east, _ = geodetic2ned(lat, lon, np.full(len(lat), up[0]), lat[0], lon[0], up[0])
    columns = {"north": np.asarray(north), "east": np.asarray(east)}
    if height is not None:
        columns["down"] = up[0] - up
    far = float(np.hypot(north, east).max())
    # A tangent plane shortens distances by the cube of the angle, over six.
    short = far**3 / (6.0 * _EARTH_RADIUS**2)
    above = f", {up[0]:.2f} m" if height is not None else ""
    words = (
        f"local plane at {lat[0]:.7f}, {lon[0]:.7f}{above} (WGS 84); at its farthest, {far:.0f} m, distances "
        f"are short by about {short:.1g} m"
    )
    return Source(time[known], columns), words
