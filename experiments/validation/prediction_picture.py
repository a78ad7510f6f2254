"""Picture of flown over predicted time, one point per flight."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from review.pictures import palette

from .flight_style import POLICY_MARKS, FlightTrack, policies_of, policy_color


def prediction_picture(flights: Sequence[FlightTrack], factors: Mapping[str, float], *, title: str) -> Figure:
    """Returns the picture of flown over predicted time.

    Flights below the diagonal finish within the predicted time.

    Args:
        flights: flights; those without a plan are left out, those that missed the goal are at the upper edge.
        factors: calibrated factor on the predicted time by policy.
        title: title of the picture.
    """
    figure = palette.new_figure(7.2, 6.4)
    axes = figure.add_subplot()
    palette.format_axes(axes)
    palette.draw_headline(axes, title)
    known = [flight for flight in flights if flight.predicted_time is not None]
    predicted = _predicted_times(known)
    flown = [flight.flown_time for flight in known if flight.reached]
    right, top = 1.06 * max(predicted, default=1.0), 1.1 * max([*flown, *predicted], default=1.0)
    for policy in policies_of(known):
        own = [flight for flight in known if flight.policy == policy]
        color, mark = policy_color(policy), POLICY_MARKS.get(policy, "o")
        reached = [flight for flight in own if flight.reached]
        inside = sum(
            flight.flown_time <= time for flight, time in zip(reached, _predicted_times(reached), strict=True)
        )
        axes.plot(
            _predicted_times(reached),
            [flight.flown_time for flight in reached],
            linestyle="none",
            marker=mark,
            color=color,
            alpha=0.45,
            markersize=4,
            markeredgewidth=0,
            label=f"{policy}: {inside} of {len(own)} within the predicted time",
        )
        missed = _predicted_times([flight for flight in own if not flight.reached])
        axes.plot(missed, [top] * len(missed), linestyle="none", marker="x", color=color, clip_on=False)
        if policy in factors:
            axes.plot(
                [0, right],
                [0, factors[policy] * right],
                color=color,
                linewidth=1.2,
                linestyle=(0, (4, 2)),
                label=f"{policy}: time bound, {factors[policy]:.2f} times predicted",
            )
    axes.plot([0, right], [0, right], color=palette.INK, linewidth=1.0, label="flown as predicted")
    axes.set_xlim(0, right)
    axes.set_ylim(0, top)
    axes.set_xlabel("predicted, s", fontsize=palette.TEXT_SIZE)
    axes.set_ylabel("flown, s", fontsize=palette.TEXT_SIZE)
    axes.legend(framealpha=0.85, edgecolor="none", fontsize=palette.SMALL_TEXT + 0.5, loc="upper left")
    return figure


def _predicted_times(flights: Sequence[FlightTrack]) -> list[float]:
    return [flight.predicted_time for flight in flights if flight.predicted_time is not None]
