"""Picture of success, predicted time and flown time over gamma."""

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from review.pictures import palette

from .flight_style import POLICY_MARKS, policy_color

ASIDE = 0.012
"""Offset between the marks of policies, so that both are visible."""


@dataclass(frozen=True, slots=True)
class LevelSummary:
    """Summary of one policy's flights at one gamma.

    Attributes:
        policy: policy of the planner.
        level: gamma.
        reached: share of flights that reached the goal, with the ends of its interval.
        inside: share that did so within the predicted time, with the ends of its interval.
        flown_time: median seconds of those that reached it; None without one.
        predicted_time: median predicted seconds; None without a plan.
    """

    policy: str
    level: float
    reached: tuple[float, float, float]
    inside: tuple[float, float, float]
    flown_time: float | None
    predicted_time: float | None


def gamma_picture(rows: Sequence[LevelSummary], *, title: str, axis: str) -> Figure:
    """Returns panels of arrivals, arrivals within the predicted time, and times.

    Args:
        rows: one per policy and gamma.
        title: title of the picture.
        axis: label of the gamma axis.
    """
    figure = palette.new_figure(7.6, 8.2)
    above, middle, below = figure.subplots(3, 1, sharex=True)
    for axes in (above, middle, below):
        palette.format_axes(axes)
    for place, policy in enumerate(dict.fromkeys(row.policy for row in rows)):
        own = sorted((row for row in rows if row.policy == policy), key=lambda row: row.level)
        color, mark = policy_color(policy), POLICY_MARKS.get(policy, "o")
        for axes, name in ((above, "reached"), (middle, "inside")):
            shares = [getattr(row, name) for row in own]
            axes.errorbar(
                [row.level + ASIDE * place for row in own],
                [share for share, _, _ in shares],
                [
                    [max(share - low, 0.0) for share, low, _ in shares],
                    [max(high - share, 0.0) for share, _, high in shares],
                ],
                color=color,
                marker=mark,
                capsize=3,
                linewidth=1.4,
                label=policy,
            )
        for name, dashes in (("flown_time", "solid"), ("predicted_time", (0, (4, 2)))):
            known = [(row.level, getattr(row, name)) for row in own if getattr(row, name) is not None]
            words = f"{policy}, {'flown' if name == 'flown_time' else 'predicted'}"
            below.plot(
                *zip(*known, strict=True) if known else ([], []),
                color=color,
                linestyle=dashes,
                marker=mark if name == "flown_time" else None,
                linewidth=1.4,
                label=words,
            )
    for axes in (above, middle):
        axes.set_ylim(-0.04, 1.04)
    below.set_ylim(bottom=0.0)
    above.set_ylabel("share that reaches the goal", fontsize=palette.TEXT_SIZE)
    middle.set_ylabel("share within the predicted time", fontsize=palette.TEXT_SIZE)
    below.set_ylabel("median time, s", fontsize=palette.TEXT_SIZE)
    below.set_xlabel(axis, fontsize=palette.TEXT_SIZE)
    palette.draw_headline(above, title)
    above.legend(frameon=False, fontsize=palette.SMALL_TEXT + 0.5, loc="lower left")
    below.legend(frameon=False, fontsize=palette.SMALL_TEXT + 0.5, loc="lower left", ncols=2)
    return figure
