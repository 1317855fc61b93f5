"""Snapshots of the beating film coloured by the potential, in the layout of Fig. 8."""

from __future__ import annotations

from pathlib import Path

from matplotlib.colors import Normalize

from stages.numerics.time_series import TimeSeries
from workflows.experiment import Experiment
from workflows.exports.sampling import FilmGrid
from workflows.figures.films import QUADS_ALONG, Panel, draw_films
from workflows.figures.held_edges import held_edges

PAPER_TIMES = (0.0, 100.0, 435.0, 575.0, 775.0, 875.0)
"""Times of the six panels, ms (caption of Fig. 8)."""

POTENTIAL = Normalize(-80.0, 20.0)
"""Common colour scale, mV: from rest to the peak of the action potential."""


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``fig8.png`` and ``fig8.svg``."""
    history, deformation = experiment.history, experiment.deformation
    grid = FilmGrid.square(experiment, QUADS_ALONG)
    control = TimeSeries(deformation.displacement, deformation.time)
    cells = TimeSeries(history.potential, history.time)
    panels = [
        Panel(
            f"t = {t:g} ms",
            grid.reference,
            grid.reference + grid.displacement(control.at(t)),
            grid.cell_field(cells.at(t)),
            held_edges(experiment),
        )
        for t in snapshot_times(float(deformation.time[-1]))
    ]
    draw_films(panels, POTENTIAL, "transmembrane potential $v$ [mV]", folder, "fig8")


def snapshot_times(end: float) -> tuple[float, ...]:
    """The paper's times if the run covers them, else six times spread evenly over it.

    Examples
    --------
    >>> snapshot_times(2000.0)
    (0.0, 100.0, 435.0, 575.0, 775.0, 875.0)
    >>> snapshot_times(50.0)
    (0.0, 10.0, 20.0, 30.0, 40.0, 50.0)
    """
    if end >= PAPER_TIMES[-1]:
        return PAPER_TIMES
    count = len(PAPER_TIMES)
    return tuple(end * i / (count - 1) for i in range(count))
