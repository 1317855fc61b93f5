"""Shapes of a film under imposed activation, coloured by how far its points have moved."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.colors import Normalize

from workflows.experiment import Experiment
from workflows.exports.sampling import FilmGrid
from workflows.figures.films import QUADS_ALONG, Panel, draw_films
from workflows.figures.held_edges import held_edges

COUNT = 6


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``shapes.png`` and ``shapes.svg``: six moments, evenly spread over the run."""
    deformation = experiment.deformation
    last = deformation.displacement.shape[0] - 1
    frames = sorted({round(last * i / (COUNT - 1)) for i in range(COUNT)})
    panels = [_panel(experiment, frame, _title(experiment, frame)) for frame in frames]
    _draw(panels, folder, "shapes")


def draw_final(runs: Mapping[str, Experiment], folder: Path, name: str) -> None:
    """Write the last shape of several runs, by their labels."""
    panels = [_panel(run, run.deformation.displacement.shape[0] - 1, k) for k, run in runs.items()]
    _draw(panels, folder, name)


def _title(experiment: Experiment, frame: int) -> str:
    deformation = experiment.deformation
    pull = f"$\\sigma_a$ = {float(np.mean(deformation.active_stress[frame])):.2g} kPa"
    if experiment.shape.along_path:
        return f"point {frame}, load factor {float(experiment.shape.load_factor[frame]):.3g}"
    return f"t = {float(deformation.time[frame]):g} ms, {pull}"


def _panel(experiment: Experiment, frame: int, title: str) -> Panel:
    grid = FilmGrid.square(experiment, QUADS_ALONG)
    net = np.asarray(experiment.deformation.displacement[frame], dtype=float)
    moved = grid.displacement(net)
    size = np.linalg.norm(moved, axis=-1)
    return Panel(title, grid.reference, grid.reference + moved, size, held_edges(experiment))


def _draw(panels: list[Panel], folder: Path, name: str) -> None:
    farthest = max(float(panel.field.max()) for panel in panels)
    scale = Normalize(0.0, farthest or 1.0)
    draw_films(panels, scale, "size of the displacement $|u|$ [mm]", folder, name)
