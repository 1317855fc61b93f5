"""Curvature and tip displacement of a film as its active stress, or its load factor, changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from stages.artefacts import ShapeMeasures
from stages.numerics.bsplines import Array
from workflows.experiment import Experiment
from workflows.figures.style import FAINT, INK, drawing, save


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``curling.png`` and ``curling.svg``."""
    shape = experiment.shape
    along, label = _abscissa(shape)
    with drawing(10.4, 3.9) as figure:
        curvature, tip = figure.subplots(1, 2)
        curvature.plot(along, shape.curvature, "o-", ms=3)
        if np.isnan(shape.curvature).all():
            said = {"ha": "center", "va": "center", "transform": curvature.transAxes}
            curvature.text(0.5, 0.5, "read off films that are flat at rest only", **said)
        curvature.set_ylabel("curvature $1/R$ [1/mm]")
        tip.plot(along, shape.tip[:, 0], "o-", ms=3, label="along the film, $u_x$")
        tip.plot(along, shape.tip[:, 2], "s-", ms=3, label="away from its plane, $u_z$")
        tip.set_ylabel("displacement of the tip [mm]")
        tip.legend()
        for letter, axes in zip("ab", (curvature, tip), strict=True):
            axes.set_title(f"({letter})", loc="left", color=INK)
            axes.set_xlabel(label)
            for load in experiment.path.limit_loads:
                axes.axvline(float(load), color=FAINT, lw=0.8, linestyle=":")
            axes.grid(alpha=0.25, linewidth=0.6)
        figure.tight_layout(w_pad=3)
        save(figure, folder, "curling")


def _abscissa(shape: ShapeMeasures) -> tuple[Array, str]:
    """What changes from frame to frame, and its name."""
    if shape.along_path:
        return shape.load_factor, "load factor"
    if shape.mean_active_stress.any():
        return shape.mean_active_stress, r"active stress $\sigma_a$, mean over the film [kPa]"
    return shape.time, "time $t$ of the loading [ms]"
