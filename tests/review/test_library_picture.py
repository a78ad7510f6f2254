"""Pictures of a library: every trim, maneuver and error."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text

from flight.automaton.library import Library
from review.pictures import palette
from review.pictures.automaton_picture import draw_automaton
from review.pictures.library_picture import BAR, library_picture
from tests.support.synthetic_log import synthetic_library

LIBRARY = synthetic_library()
ALONE = replace(
    LIBRARY,
    trims=LIBRARY.trims[3:4],
    maneuvers=(),
    conditions=replace(LIBRARY.conditions, maneuver_end=None),
)


def circles(figure: Figure) -> int:
    return sum(line.get_marker() == "o" for line in figure.findobj(Line2D))


def test_the_automaton_has_a_circle_for_each_trim_and_an_arrow_for_each_maneuver() -> None:
    figure = palette.new_figure(6.0, 6.0)
    axes = figure.subplots()
    draw_automaton(axes, LIBRARY)
    assert circles(figure) == 7
    assert len(axes.findobj(FancyArrowPatch)) == 22
    assert {str(number) for number in range(1, 23)} <= {text.get_text() for text in axes.texts}


def bars(figure: Figure, panel: str) -> list[tuple[float, float]]:
    """Returns the two ends of every bar of a panel, as they are drawn: to gamma -1, then to +1."""
    (axes,) = (axes for axes in figure.findobj(type(figure.axes[0])) if axes.get_xlabel() == panel)
    thick = [line for line in axes.lines if line.get_linewidth() == BAR]
    return [tuple(np.asarray(line.get_xdata())) for line in thick]


@pytest.mark.parametrize(("library", "arrows"), [(ALONE, 0), (LIBRARY, 22)])
def test_a_library_is_drawn_with_every_number_and_its_signed_error(
    library: Library, arrows: int, tmp_path: Path
) -> None:
    figure = library_picture(library)
    figure.savefig(tmp_path / "library.png")
    assert circles(figure) == len(library.trims)
    assert len(figure.findobj(FancyArrowPatch)) == arrows
    ends = [
        (trim.velocity.side, trim.velocity.side + sign * trim.error.side)
        for trim in library.trims
        for sign in (-1, 1)
    ]
    np.testing.assert_allclose(bars(figure, "side, m/s"), ends)
    if arrows:
        ends = [
            (row.duration, row.duration + sign * row.error.duration)
            for row in library.maneuvers
            for sign in (-1, 1)
        ]
        np.testing.assert_allclose(bars(figure, "duration, s"), ends)
    words = {text.get_text() for text in figure.findobj(Text)}
    assert {f"{trim.name}  {trim.id}" for trim in library.trims} <= words
