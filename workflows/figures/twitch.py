"""Active stress and tip displacement of a twitching film over time."""

from __future__ import annotations

from pathlib import Path

from workflows.experiment import Experiment
from workflows.figures.style import INK, drawing, save


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``twitch.png`` and ``twitch.svg``."""
    shape = experiment.shape
    with drawing(10.4, 3.9) as figure:
        stress, tip = figure.subplots(1, 2)
        stress.plot(shape.time, shape.mean_active_stress)
        stress.set_ylabel(r"active stress $\sigma_a$, mean over the film [kPa]")
        stress.set_ylim(bottom=0)
        tip.plot(shape.time, shape.tip[:, 0], label="along the film, $u_x$")
        tip.plot(shape.time, shape.tip[:, 2], label="away from its plane, $u_z$")
        tip.set_ylabel("displacement of the tip [mm]")
        tip.legend()
        for letter, axes in zip("ab", (stress, tip), strict=True):
            axes.set_title(f"({letter})", loc="left", color=INK)
            axes.set_xlabel("time $t$ [ms]")
            axes.set_xlim(shape.time[0], shape.time[-1])
            axes.grid(alpha=0.25, linewidth=0.6)
        figure.tight_layout(w_pad=3)
        save(figure, folder, "twitch")
