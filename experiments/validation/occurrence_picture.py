"""Picture of trim and maneuver usage (thesis, Figures 37 to 48)."""

from collections import Counter
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from flight.automaton.library import Library
from review.pictures import palette

from .flight_style import FlightTrack, LegTrack, policies_of, policy_color


def occurrence_picture(flights: Sequence[FlightTrack], library: Library, *, title: str) -> Figure:
    """Returns bars of coasting time by trim and of maneuver counts.

    Args:
        flights: flights of one policy or more.
        library: library of trims and maneuvers.
        title: title of the picture.
    """
    figure = palette.new_figure(9.6, 6.4)
    above, below = figure.subplots(2, 1)
    trims = [trim.id for trim in library.trims]
    _bars(above, flights, trims, lambda leg: leg.trim if leg.maneuver is None else None, weigh=True)
    above.set_xticks(range(len(trims)), [f"{trim.id}\n{trim.name}" for trim in library.trims])
    above.set_ylabel("share of coasting time", fontsize=palette.TEXT_SIZE)
    palette.draw_headline(above, f"{title}: trims")
    maneuvers = [maneuver.id for maneuver in library.maneuvers]
    _bars(below, flights, maneuvers, lambda leg: leg.maneuver, weigh=False)
    labels = [f"{one.id}\n{one.from_trim}\N{EN DASH}{one.to_trim}" for one in library.maneuvers]
    below.set_xticks(range(len(maneuvers)), labels)
    below.set_ylabel("share of maneuvers", fontsize=palette.TEXT_SIZE)
    palette.draw_headline(below, "Maneuvers, by id and trims")
    palette.draw_legend_above(above, list(above.containers))
    return figure


def _bars(
    axes: Axes,
    flights: Sequence[FlightTrack],
    ids: Sequence[int],
    which: Callable[[LegTrack], int | None],
    *,
    weigh: bool,
) -> None:
    palette.format_axes(axes)
    axes.grid(visible=False, axis="x")
    policies = policies_of(flights)
    width = 0.8 / max(len(policies), 1)
    for place, policy in enumerate(policies):
        counts: Counter[int] = Counter()
        for leg in (leg for flight in flights if flight.policy == policy for leg in flight.legs):
            number = which(leg)
            if number is not None:
                counts[number] += leg.duration if weigh else 1  # type: ignore[assignment]
        total = sum(counts.values()) or 1.0
        at = np.arange(len(ids)) + (place - (len(policies) - 1) / 2) * width
        axes.bar(
            at,
            [counts[number] / total for number in ids],
            0.92 * width,
            color=policy_color(policy),
            label=policy,
        )
