"""Snapshots of the beating film coloured by the potential, in the layouts of Figs 8 and 10."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.colors import Normalize

from stages.numerics.time_series import TimeSeries
from workflows.experiment import Experiment
from workflows.exports.sampling import FilmGrid
from workflows.figures.films import QUADS_ALONG, Panel, draw_films
from workflows.figures.held_edges import held_edges

PAPER_TIMES = {
    "fig8": (0.0, 100.0, 435.0, 575.0, 775.0, 875.0),
    "fig10": (0.0, 100.0, 435.0, 575.0, 775.0, 875.0, 1010.0, 2000.0),
}
"""Times of the panels, ms (captions of Figs 8 and 10)."""

POTENTIAL = Normalize(-80.0, 20.0)
"""Common colour scale, mV: from rest to the peak of the action potential."""


def write(experiment: Experiment, folder: Path, name: str) -> None:
    """Write ``name.png`` and ``name.svg``."""
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
        for t in snapshot_times(PAPER_TIMES[name], float(deformation.time[-1]))
    ]
    draw_films(panels, POTENTIAL, "transmembrane potential $v$ [mV]", folder, name)


def snapshot_times(times: Sequence[float], end: float) -> tuple[float, ...]:
    """The given times if the run covers them, else as many spread evenly over it.

    Examples
    --------
    >>> snapshot_times((0.0, 100.0, 775.0), 2000.0)
    (0.0, 100.0, 775.0)
    >>> snapshot_times((0.0, 100.0, 775.0), 50.0)
    (0.0, 25.0, 50.0)
    """
    if end >= times[-1]:
        return tuple(times)
    return tuple(end * i / (len(times) - 1) for i in range(len(times)))
