"""Campaign of half-minute flights: three trims, six maneuvers."""

from dataclasses import replace
from pathlib import Path

import libraries
from flight.automaton.library_file import library_text, read_library

_TRIMS = (1, 2, 3)

_CAMPAIGN = """name = "small"
library = "{library}"
wind = "gtmax"
altitude = 30.0
flights = {flights}
nominal_flights = {nominal}
coasting_range = [0.5, 1.5]

[maneuver_end.gtmax]
dwell = 0.4
timeout = 15.0
band = [
    {{ trim = 1, forward = 0.35, side = 0.45, yaw_rate = 0.08 }},
    {{ trim = 2, forward = 0.35, side = 0.45, yaw_rate = 0.08 }},
    {{ trim = 3, forward = 0.35, side = 0.45, yaw_rate = 0.08 }},
]
"""


def write_small_campaign(folder: Path, *, flights: int, nominal: int = 0) -> Path:
    """Writes campaign and library files; returns the campaign's path."""
    whole = read_library(libraries.FOLDER / "thesis-gtmax.json")
    small = replace(
        whole,
        name="small-trims",
        trims=tuple(trim for trim in whole.trims if trim.id in _TRIMS),
        maneuvers=tuple(row for row in whole.maneuvers if {row.from_trim, row.to_trim} <= {*_TRIMS}),
    )
    library, campaign = folder / "small-trims.json", folder / "small.toml"
    library.write_text(library_text(small))
    campaign.write_text(_CAMPAIGN.format(library=library.resolve(), flights=flights, nominal=nominal))
    return campaign
