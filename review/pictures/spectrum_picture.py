"""Picture of gust spectra, measured and analytic."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float
from matplotlib.figure import Figure


def draw_spectra(
    frequency: Float[np.ndarray, "n"],
    spectra: Mapping[str, tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]],
    path: Path,
) -> None:
    """Writes a picture with one panel per gust component.

    Args:
        frequency: rad/s.
        spectra: measured and analytic one-sided spectrum by component, m2/s2 per rad/s.
        path: the picture file; its suffix selects the format.
    """
    figure = Figure(figsize=(10.0, 3.6), layout="constrained")
    panels = np.atleast_1d(figure.subplots(1, len(spectra), sharey=True))
    for panel, (name, (measured, analytic)) in zip(panels, spectra.items(), strict=True):
        panel.loglog(frequency, measured, color="0.6", linewidth=0.8, label="simulated")
        panel.loglog(frequency, analytic, color="C3", label="MIL-F-8785C")
        panel.set_title(f"gust {name}")
        panel.set_xlabel("rad/s")
    panels[0].set_ylabel("m²/s² per rad/s")
    panels[0].legend()
    figure.savefig(path, dpi=120)
