"""The deformed film over time for ParaView, with what its cells do."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.time_series import TimeSeries
from workflows.experiment import Experiment
from workflows.exports.sampling import FilmGrid
from workflows.exports.vtkhdf import Field, write_film

QUADS_PER_ELEMENT = 2
"""Along X; a quadratic element bends visibly within itself."""

SCALARS = ("potential", "active_stress")


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``film.vtkhdf`` into a folder, one frame per mechanics time."""
    elements = experiment.geometry.mid_surface.patch.first.elements
    grid = FilmGrid.square(experiment, QUADS_PER_ELEMENT * elements)
    deformation, history = experiment.deformation, experiment.history
    time = np.asarray(deformation.time, dtype=float)

    def of_cells(name: str) -> Field:
        cells = TimeSeries(getattr(history, name), history.time)

        def field(t: float) -> Array:
            return grid.cell_field(cells.at(t))

        return field

    control = TimeSeries(deformation.displacement, time)
    scalars = {name: of_cells(name) for name in SCALARS}
    write_film(folder / "film.vtkhdf", grid, time, control.at, scalars)
