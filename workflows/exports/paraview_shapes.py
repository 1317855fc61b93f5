"""The deformed film over time for ParaView, with what its fibres feel."""

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

SCALARS = ("active_stress", "fibre_stretch")


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``film.vtkhdf`` into a folder, one frame per mechanics time."""
    elements = experiment.geometry.mid_surface.patch.first.elements
    grid = FilmGrid.square(experiment, QUADS_PER_ELEMENT * elements)
    deformation = experiment.deformation
    time = np.asarray(deformation.time, dtype=float)

    def of_fibres(name: str) -> Field:
        fibres = TimeSeries(getattr(deformation, name), time)

        def field(t: float) -> Array:
            return grid.gauss_field(fibres.at(t))

        return field

    def factor(t: float) -> Array:
        return np.full(grid.shape, float(np.interp(t, time, experiment.shape.load_factor)))

    control = TimeSeries(deformation.displacement, time)
    scalars = {name: of_fibres(name) for name in SCALARS}
    if experiment.shape.along_path:
        scalars["load_factor"] = factor
    write_film(folder / "film.vtkhdf", grid, time, control.at, scalars)
