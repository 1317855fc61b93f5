"""What becomes of S3 by the time at which it is given."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from stages.paced_artefacts import VulnerableWindow
from workflows.experiment import Experiment
from workflows.figures.style import FAINT, INK, PROBE_COLOURS, drawing, save

OUTCOMES = (
    ("no further wave", FAINT, "x"),
    ("passes", PROBE_COLOURS[0], "o"),
    ("comes round again", PROBE_COLOURS[1], "s"),
)


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``vulnerable-window.png`` and ``vulnerable-window.svg``."""
    measured: VulnerableWindow = experiment.load("vulnerable_window")
    with drawing(7.4, 8.2) as figure:
        share, counts, life = figure.subplots(3, 1, sharex=True)
        share.plot(measured.time, measured.activated_share, color=INK, lw=1.0)
        share.plot(measured.time, measured.reactivated_share, color=INK, lw=1.0, ls="--")
        share.set_ylabel("share of the film activated\n(dashed: and again)")
        for i, name in enumerate(measured.probe_names):
            colour = PROBE_COLOURS[i % len(PROBE_COLOURS)]
            look = {"color": colour, "lw": 1.2 + 1.4 * (len(measured.probe_names) - 1 - i)}
            counts.step(measured.time, measured.activations[:, i], where="mid", label=name, **look)
        counts.set_ylabel("activations that S3 adds")
        counts.legend(ncols=len(measured.probe_names))
        life.set_ylabel("life time [ms]")
        life.set_xlabel("time of S3 [ms]")
        _mark(share, measured, measured.activated_share)
        _mark(life, measured, measured.life_time)
        share.legend()
        for letter, axes in zip("abc", (share, counts, life), strict=True):
            axes.set_title(f"({letter})", loc="left", color=INK)
            axes.set_ylim(bottom=0)
            axes.grid(alpha=0.25, linewidth=0.6)
        figure.tight_layout(h_pad=1.5)
        save(figure, folder, "vulnerable-window")


def _mark(axes: Axes, measured: VulnerableWindow, values: np.ndarray) -> None:
    """The cases, told apart by their outcome."""
    for code, (label, colour, marker) in enumerate(OUTCOMES):
        those = measured.outcome == code
        axes.scatter(
            measured.time[those], values[those], color=colour, marker=marker, label=label, zorder=3
        )
