"""The price of robustness as a picture: how much time how much uncertainty costs."""

from collections.abc import Sequence
from math import isfinite

from matplotlib.figure import Figure

from . import palette


def price_picture(mission: str, points: Sequence[tuple[float, float]]) -> Figure:
    """Returns the picture of worst-case time against uncertainty level, with its price beside it.

    Args:
        mission: its name.
        points: gamma and seconds, from gamma 0 up; infinite seconds where there is no plan.
    """
    figure = palette.new_figure(6.4, 4.0)
    axes = figure.add_subplot()
    palette.format_axes(axes)
    palette.draw_headline(axes, f"{mission}: what robustness costs")
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
        share.set_ylabel("alpha: in nominal optima", fontsize=palette.TEXT_SIZE)
        share.tick_params(labelsize=palette.SMALL_TEXT + 0.5)
    return figure
