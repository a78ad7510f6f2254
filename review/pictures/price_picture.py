"""Price of robustness: worst-case time over gamma."""

from collections.abc import Sequence
from math import isfinite

from matplotlib.figure import Figure

from . import palette


def price_picture(mission: str, points: Sequence[tuple[float, float]]) -> Figure:
    """Returns the picture of worst-case time and its price over gamma.

    Args:
        mission: name of the mission.
        points: gamma and seconds, from gamma 0 up; infinite seconds without a plan.
    """
    figure = palette.new_figure(6.4, 4.0)
    axes = figure.add_subplot()
    palette.format_axes(axes)
    palette.draw_headline(axes, f"{mission}: price of robustness")
    known = [(gamma, cost) for gamma, cost in points if isfinite(cost)]
    axes.plot(
        [gamma for gamma, _ in known], [cost for _, cost in known], color=palette.TRUE_COLOR, linewidth=1.6
    )
    for gamma in (gamma for gamma, cost in points if not isfinite(cost)):
        axes.axvline(gamma, color=palette.ALARM, linewidth=0.6)
    axes.set_xlim(0, 1)
    axes.set_xlabel("uncertainty level gamma", fontsize=palette.TEXT_SIZE)
    axes.set_ylabel("worst-case time, s", fontsize=palette.TEXT_SIZE)
    if known and known[0][1] > 0:
        share = axes.twinx()
        low, high = axes.get_ylim()
        share.set_ylim(low / known[0][1], high / known[0][1])
        share.spines[["top", "left"]].set_visible(False)
        share.set_ylabel("alpha: worst-case over nominal time", fontsize=palette.TEXT_SIZE)
        share.tick_params(labelsize=palette.SMALL_TEXT + 0.5)
    return figure
