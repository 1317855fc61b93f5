"""Buckling modes of a film, each with its load factor."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.colors import Normalize

from workflows.experiment import Experiment
from workflows.exports.sampling import FilmGrid
from workflows.figures.films import QUADS_ALONG, Panel, draw_films
from workflows.figures.held_edges import held_edges

COUNT = 6
"""Modes that are drawn."""

SIZE = 0.1
"""Largest displacement in the picture, relative to the film's length."""


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``modes.png`` and ``modes.svg``: the first modes."""
    grid = FilmGrid.square(experiment, QUADS_ALONG)
    height = SIZE * float(np.ptp(grid.reference[..., 0]))
    panels = []
    modes = experiment.buckling
    for factor, shape in zip(modes.factors[:COUNT], modes.shapes[:COUNT], strict=True):
        mode = grid.displacement(np.asarray(shape))
        moved = grid.reference + height * mode
        size = np.linalg.norm(mode, axis=-1)
        panels.append(
            Panel(
                f"load factor {float(factor):.4g}",
                grid.reference,
                moved,
                size,
                held_edges(experiment),
            )
        )
    draw_films(panels, Normalize(0.0, 1.0), "size of the mode", folder, "modes")
