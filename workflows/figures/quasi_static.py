"""Figs 3 to 5: what a curled film looks like, over peak stress and over thickness."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from workflows.experiment import Experiment
from workflows.exports.csvfiles import write_columns
from workflows.figures.shapes import draw_final
from workflows.figures.style import drawing, save
from workflows.stoney import modified_stoney
from workflows.workflow import Quantity

Runs = Mapping[str, Experiment]
MICROMETRES = 1000.0
"""In a millimetre."""


def draw_stresses(runs: Runs, folder: Path, name: str) -> dict[str, Quantity]:
    """Fig. 3: curvature over peak stress."""
    found = {
        "peak_stress": peaks(runs),
        "curvature": Quantity(
            [float(run.shape.curvature[-1]) for run in runs.values()],
            "1/mm",
            "curvature at each of them (eq. 101)",
        ),
    }
    write_columns(folder / f"{name}.csv", found)
    with drawing(5.6, 3.9) as figure:
        axes = figure.subplots()
        axes.plot(listed(found["peak_stress"]), listed(found["curvature"]), "o-", label="shell")
        over_peaks(axes)
        figure.tight_layout()
        save(figure, folder, name)
    return found


def draw_shapes(runs: Runs, folder: Path, name: str) -> dict[str, Quantity]:
    """Fig. 4: final shapes."""
    titles = {f"$\\hat P$ = {label}": run for label, run in runs.items()}
    draw_final(titles, folder, name)
    found = {"peak_stress": peaks(runs)}
    for i, (axis, meaning) in enumerate((("ux", "along the film"), ("uz", "away from its plane"))):
        found[f"tip_{axis}"] = Quantity(
            [float(run.shape.tip[-1, 2 * i]) for run in runs.values()],
            "mm",
            f"displacement of the tip {meaning}",
        )
    found["turning_angle"] = Quantity(
        [float(run.shape.turning[-1]) for run in runs.values()],
        "degree",
        "how far the film turns from the clamp to the tip",
    )
    write_columns(folder / f"{name}.csv", found)
    return found


def draw_thicknesses(runs: Runs, folder: Path, name: str) -> dict[str, Quantity]:
    """Fig. 5: curvature over the thickness of the substrate, and eq. 102 beside it."""
    thickness: list[float | None] = [
        float(run.config.geometry.substrate_thickness) for run in runs.values()
    ]
    found = {
        "substrate_thickness": Quantity(thickness, "mm", "thicknesses d_s of the substrate"),
        "curvature": Quantity(
            [float(run.shape.curvature[-1]) for run in runs.values()],
            "1/mm",
            "curvature at each of them (eq. 101)",
        ),
        "stoney_curvature": Quantity(
            [modified_stoney(run.config) for run in runs.values()],
            "1/mm",
            "modified Stoney approximation (eq. 102); it contains no peak stress",
        ),
    }
    write_columns(folder / f"{name}.csv", found)
    with drawing(5.6, 3.9) as figure:
        axes = figure.subplots()
        depth = MICROMETRES * np.array(listed(found["substrate_thickness"]))
        axes.plot(depth, listed(found["curvature"]), "o-", label="shell")
        axes.plot(depth, listed(found["stoney_curvature"]), "s--", label="modified Stoney, eq. 102")
        axes.set_xlabel("thickness of the substrate $d_s$ [µm]")
        axes.set_ylabel("curvature $1/R$ [1/mm]")
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.25, linewidth=0.6)
        axes.legend()
        figure.tight_layout()
        save(figure, folder, name)
    return found


def peaks(runs: Runs) -> Quantity:
    """Peak stresses of the runs."""
    values: list[float | None] = [float(r.config.activation.peak_stress) for r in runs.values()]
    return Quantity(values, "kPa", "peak stresses P of the imposed activation")


def over_peaks(axes: Axes) -> None:
    """Curvature over peak stress."""
    axes.set_xlabel(r"peak stress $\hat P$ [kPa]")
    axes.set_ylabel("curvature $1/R$ [1/mm]")
    axes.set_xlim(left=0)
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.25, linewidth=0.6)


def listed(quantity: Quantity) -> list[float]:
    """Values of a list, NaN where there is none."""
    assert isinstance(quantity.value, list)
    return [np.nan if value is None else value for value in quantity.value]
