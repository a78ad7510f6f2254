"""Writes the campaigns for trends and their automata: `python -m tools.trend_campaigns`."""

from collections.abc import Callable

import libraries
from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from identification.data_sheet import data_sheet
from identification.design.trend_automaton import straight_automaton, turns_automaton
from scenarios.find import CAMPAIGNS

WIND, ALTITUDE = "gtmax", 30.0

HEAD = """# Written by `python -m tools.trend_campaigns`: {what}.
# Bands are half widths around each trim's velocity, m/s, m/s, rad/s; dwell and timeout in s.

name = "{name}"
library = "{name}" # names the trims and the maneuvers
wind = "{wind}"
altitude = {altitude}
flights = {flights}
coasting_range = [{shortest}, {longest}]

[maneuver_end.{wind}]
dwell = {dwell}
timeout = {timeout}
band = [
"""


def main() -> None:
    """Writes both campaigns, and their automata with a data sheet each."""
    _write(straight_automaton, "straight flight in steps of 8 ft/s", flights=12, coasts=(3.0, 6.0))
    _write(
        turns_automaton, "turns in steps of 0.1 rad/s and a grid to grow from", flights=8, coasts=(1.5, 4.0)
    )


def _write(
    automaton: Callable[..., Library], what: str, *, flights: int, coasts: tuple[float, float]
) -> None:
    library = automaton(wind=WIND, altitude=ALTITUDE)
    path = libraries.FOLDER / f"{library.name}.json"
    path.write_text(library_text(library), encoding="utf-8")
    path.with_suffix(".md").write_text(data_sheet(library), encoding="utf-8")
    rule = library.conditions.maneuver_end
    assert rule is not None
    head = HEAD.format(
        what=what,
        name=library.name,
        wind=WIND,
        altitude=ALTITUDE,
        flights=flights,
        shortest=coasts[0],
        longest=coasts[1],
        dwell=rule.dwell,
        timeout=rule.timeout,
    )
    bands = "".join(
        f"    {{ trim = {trim}, forward = {one.forward}, side = {one.side}, yaw_rate = {one.yaw_rate} }},\n"
        for trim, one in rule.bands.items()
    )
    (CAMPAIGNS / f"{library.name}.toml").write_text(f"{head}{bands}]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
