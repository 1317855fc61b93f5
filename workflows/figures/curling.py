"""Curvature and tip displacement of a film as its active stress grows."""

from __future__ import annotations

from pathlib import Path

from workflows.experiment import Experiment
from workflows.figures.style import INK, drawing, save


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``curling.png`` and ``curling.svg``."""
    shape = experiment.shape
    stress = shape.mean_active_stress
    with drawing(10.4, 3.9) as figure:
        curvature, tip = figure.subplots(1, 2)
        curvature.plot(stress, shape.curvature, "o-", ms=3)
        curvature.set_ylabel("curvature $1/R$ [1/mm]")
        tip.plot(stress, shape.tip[:, 0], "o-", ms=3, label="along the film, $u_x$")
        tip.plot(stress, shape.tip[:, 2], "s-", ms=3, label="away from its plane, $u_z$")
        tip.set_ylabel("displacement of the tip [mm]")
        tip.legend()
        for letter, axes in zip("ab", (curvature, tip), strict=True):
            axes.set_title(f"({letter})", loc="left", color=INK)
            axes.set_xlabel(r"active stress $\sigma_a$, mean over the film [kPa]")
            axes.grid(alpha=0.25, linewidth=0.6)
        figure.tight_layout(w_pad=3)
        save(figure, folder, "curling")
