"""Snapshots of the beating film coloured by the potential, in the layout of Fig. 8."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]  # ships no types

from stages.numerics.bsplines import Array
from stages.numerics.time_series import TimeSeries
from workflows.experiment import Experiment
from workflows.exports.sampling import FilmGrid
from workflows.figures.style import FAINT, INK, drawing, save

PAPER_TIMES = (0.0, 100.0, 435.0, 575.0, 775.0, 875.0)
"""Times of the six panels, ms (caption of Fig. 8)."""

POTENTIAL = Normalize(-80.0, 20.0)
"""Common colour scale, mV: from rest to the peak of the action potential."""

COLOURS = colormaps["viridis"]
QUADS_ALONG = 96
COLUMNS = 3


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``fig8.png`` and ``fig8.svg``."""
    history, deformation = experiment.history, experiment.deformation
    times = snapshot_times(float(deformation.time[-1]))
    grid = FilmGrid.square(experiment, QUADS_ALONG)
    control = TimeSeries(deformation.displacement, deformation.time)
    cells = TimeSeries(history.potential, history.time)
    shapes = [grid.reference + grid.displacement(control.at(t)) for t in times]
    potentials = [grid.cell_field(cells.at(t)) for t in times]
    box = _common_box([grid.reference, *shapes])
    rows = -(-len(times) // COLUMNS)
    with drawing(10.4, 0.2 + 2.4 * rows) as figure:
        for i, t in enumerate(times):
            axes = figure.add_subplot(rows, COLUMNS, i + 1, projection="3d", computed_zorder=False)
            _draw_film(axes, grid.reference, shapes[i], potentials[i], box)
            if i == 0:
                _draw_measures(axes, grid.reference)
            axes.set_title(f"({'abcdefgh'[i]})  t = {t:g} ms", y=0.9, color=INK)
        figure.subplots_adjust(left=0.0, right=0.9, bottom=0.0, top=1.0, wspace=0.0, hspace=0.0)
        bar = figure.add_axes((0.925, 0.2, 0.014, 0.6))
        scale = ScalarMappable(POTENTIAL, COLOURS)
        figure.colorbar(scale, cax=bar, label="transmembrane potential $v$ [mV]", extend="both")
        save(figure, folder, "fig8")


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


def _draw_film(
    axes: Axes3D, reference: Array, shape: Array, potential: Array, box: tuple[Array, Array]
) -> None:
    sides = (reference[:, 0], reference[-1], reference[::-1, -1], reference[0, ::-1])
    at_rest = np.concatenate(sides)
    axes.plot(*at_rest.T, color=FAINT, lw=0.7, linestyle=(0, (4, 3)), zorder=1, clip_on=False)
    middle = (potential[:-1, :-1] + potential[1:, :-1] + potential[1:, 1:] + potential[:-1, 1:]) / 4
    film = axes.plot_surface(
        *np.moveaxis(shape, -1, 0),
        facecolors=COLOURS(POTENTIAL(middle)),
        rstride=1,
        cstride=1,
        shade=False,
        linewidth=0,
        antialiased=False,
        zorder=2,
    )
    film.set_rasterized(True)
    film.set_clip_on(False)
    for edge in (shape[-1], shape[:, 0], shape[:, -1]):
        axes.plot(*edge.T, color=INK, lw=0.8, zorder=3, clip_on=False)
    axes.plot(*shape[0].T, color=INK, lw=3.0, zorder=3, clip_on=False)  # the clamp
    low, high = box
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    # A box is drawn with a fixed diagonal; the zoom undoes that, so that all films are equally long.
    size = high - low
    axes.set_box_aspect(size, zoom=1.04 * np.linalg.norm(size) / np.linalg.norm(size[:2]))
    axes.view_init(elev=24, azim=-62)
    axes.set_axis_off()


def _draw_measures(axes: Axes3D, reference: Array) -> None:
    """Directions, a length of 1 mm, and which edge is clamped, in the plane of the film at rest."""
    corner, far = reference[0, 0], reference[-1, -1]
    bar = corner + np.array([[0.0, -0.3, 0.0], [1.0, -0.3, 0.0]])
    axes.plot(*bar.T, color=INK, lw=1.6, clip_on=False)
    look = {"color": INK, "fontsize": 9, "ha": "center", "va": "center"}
    middle = 0.5 * (corner + far)
    axes.text(corner[0] + 0.6, corner[1] - 0.58, corner[2], "1 mm", **look)
    axes.text(middle[0] + 0.5, corner[1] - 0.35, corner[2], "$X$", **look)
    axes.text(far[0] + 0.3, middle[1], far[2], "$Y$", **look)
    axes.text(corner[0] - 0.6, middle[1] + 0.45, corner[2], "clamped", **look)


def _common_box(shapes: list[Array]) -> tuple[Array, Array]:
    """Corners of a box that holds all shapes, a little wider, so that all panels share one scale."""
    points = np.concatenate([shape.reshape(-1, 3) for shape in shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.02 * float((high - low).max())
    return low - margin, high + margin
