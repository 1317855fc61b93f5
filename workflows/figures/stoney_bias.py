"""Bias of narrow-strip (Stoney) formulas over the width of films, for several thicknesses."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_columns
from workflows.figures.quasi_static import MICROMETRES
from workflows.figures.stoney_place import draw_limits, label_axes, shares
from workflows.figures.style import PROBE_COLOURS, drawing, save
from workflows.stoney import bias_quantities, plies
from workflows.workflow import Quantity

MEANINGS = {
    "substrate_thickness": "thickness of the substrate of each film",
    "active_thickness": "thickness of its muscle",
    "width_over_length": "its width over its length",
    "curvature": "its curvature, from the length of its projection (eq. 101)",
}


def draw(runs: Mapping[str, Experiment], folder: Path, name: str) -> dict[str, Quantity]:
    """Shell runs as points, the theory of long films as curves, one colour per thickness."""
    columns = _columns(runs)
    write_columns(folder / f"{name}.csv", columns)
    table = np.array([quantity.value for quantity in columns.values()], dtype=float).T
    place = {key: i for i, key in enumerate(columns)}
    ratio, share = table[:, place["width_over_length"]], table[:, place["strip_share"]]
    depth = table[:, place["substrate_thickness"]]
    with drawing(7.2, 4.4) as figure:
        axes = figure.subplots()
        for colour, thickness in zip(PROBE_COLOURS, dict.fromkeys(depth), strict=False):
            mine = depth == thickness
            wide = list(runs.values())[int(np.flatnonzero(mine)[-1])]
            muscle = wide.config.geometry.active_thickness
            label = f"$d_s$ = {MICROMETRES * thickness:g} µm, $d_a/d_s$ = {muscle / thickness:.2f}"
            axes.plot(ratio[mine], share[mine], "o", color=colour, label=label)
            layers = plies(wide.config, float(table[mine, place["active_stress"]].mean()))
            if layers is not None:
                fine = np.geomspace(ratio.min() / 1.5, ratio.max() * 1.2, 120)
                widths = wide.config.geometry.length * fine
                axes.plot(fine, shares(layers, widths), color=colour, lw=1.2)
                if colour == PROBE_COLOURS[0]:
                    draw_limits(axes, layers, fine[0], fine[-1])
        label_axes(axes)
        axes.set_xlim(ratio.min() / 1.5, ratio.max() * 1.2)
        axes.set_ylim(0.68, 1.16)
        axes.legend(title="points: shell, curves: theory of long films", loc="upper right")
        figure.tight_layout()
        save(figure, folder, name)
    return columns


def _columns(runs: Mapping[str, Experiment]) -> dict[str, Quantity]:
    rows = []
    for run in runs.values():
        film = run.config.geometry
        row: dict[str, tuple[float | None, str, str]] = {
            "substrate_thickness": (film.substrate_thickness, "mm", ""),
            "active_thickness": (film.active_thickness, "mm", ""),
            "width_over_length": (film.width / film.length, "", ""),
            "curvature": (float(run.shape.curvature[-1]), "1/mm", ""),
        }
        for key, quantity in bias_quantities(run).items():
            assert not isinstance(quantity.value, list)
            row[key] = (quantity.value, quantity.unit, quantity.meaning)
        rows.append(row)
    return {
        key: Quantity([row[key][0] for row in rows], unit, meaning or MEANINGS[key])
        for key, (_, unit, meaning) in rows[0].items()
    }
