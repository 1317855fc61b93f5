"""Buckling modes for ParaView: mode k at the time k."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stages.numerics.bsplines import Array
from workflows.experiment import Experiment
from workflows.exports.paraview_shapes import QUADS_PER_ELEMENT
from workflows.exports.sampling import FilmGrid
from workflows.exports.vtkhdf import write_film

SIZE = 0.1
"""Largest displacement, relative to the film's length."""


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``modes.vtkhdf`` into a folder, with the load factor as a field."""
    grid = FilmGrid.square(
        experiment, QUADS_PER_ELEMENT * experiment.geometry.mid_surface.patch.first.elements
    )
    modes = experiment.buckling
    size = SIZE * float(np.ptp(grid.reference[..., 0]))

    def shape(number: float) -> Array:
        return size * np.asarray(modes.shapes[round(number) - 1])

    def factor(number: float) -> Array:
        return np.full(grid.shape, float(modes.factors[round(number) - 1]))

    numbers = np.arange(1.0, len(modes.factors) + 1.0)
    write_film(folder / "modes.vtkhdf", grid, numbers, shape, {"load_factor": factor})
