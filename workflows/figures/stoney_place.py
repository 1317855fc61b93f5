"""How much of the true active stress a narrow-strip formula returns for a film, and for wider ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from stages.numerics.bsplines import Array
from workflows.experiment import Experiment
from workflows.figures.style import FAINT, INK, PROBE_COLOURS, drawing, save
from workflows.stoney import bias_quantities, plies
from workflows.theory.anticlastic import film_of_width
from workflows.theory.bilayer import Ply, cylindrical, free_strip

TICKS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
NARROWEST = 0.01
"""Of the length."""


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``stoney.png`` and ``stoney.svg``: this film beside the theory of long films of any width."""
    film = experiment.config.geometry
    found = bias_quantities(experiment)
    stress, share = found["active_stress"].value, found["strip_share"].value
    with drawing(8.6, 4.2) as figure:
        axes = figure.subplots()
        if isinstance(stress, float) and isinstance(share, float):
            layers = plies(experiment.config, stress)
            assert layers is not None
            place = film.width / film.length
            widest = max(2.0, 1.5 * place)
            ratios = np.geomspace(NARROWEST, widest, 120)
            draw_limits(axes, layers, NARROWEST, widest)
            axes.plot(ratios, shares(layers, film.length * ratios), label="long film, theory")
            axes.plot(place, share, "o", color=PROBE_COLOURS[1], ms=8, label="this film")
            axes.legend(loc="upper right")
        else:
            reason = (
                "no closed form for this film\n(flat, two layers, clamped at X = 0 alone, no loads, "
                "fibres along X, a stress > 0)"
            )
            axes.text(0.5, 0.5, reason, ha="center", va="center", transform=axes.transAxes)
        label_axes(axes)
        axes.set_xlim(left=NARROWEST)
        figure.tight_layout()
        save(figure, folder, "stoney")


def shares(layers: list[Ply], widths: Array) -> Array:
    """Curvature of long films of some widths over that of a narrow strip."""
    strip = free_strip(layers).curvature_x
    return np.array([film_of_width(layers, float(width)).curvature for width in widths]) / strip


def draw_limits(axes: Axes, layers: list[Ply], narrowest: float, widest: float) -> None:
    """Both closed forms, written on their lines."""
    limit = cylindrical(layers).curvature_x / free_strip(layers).curvature_x
    texts = (
        (1.0, "narrow strip: the formula is right", "bottom"),
        (limit, f"cylindrical bending: {limit:.0%}", "top"),
    )
    for level, text, side in texts:
        axes.axhline(level, color=FAINT, lw=0.9, ls="--")
        axes.text(narrowest, level, f" {text}", color=INK, fontsize=9, va=side)


def label_axes(axes: Axes) -> None:
    """Common axes of these figures."""
    axes.set_xscale("log")
    axes.set_xticks(TICKS, [f"{tick:g}" for tick in TICKS])
    axes.set_xlabel("width / length of the film")
    axes.set_ylabel("stress by strip formula / true stress")
    axes.set_ylim(0.65, 1.08)
    axes.grid(alpha=0.25, linewidth=0.6)
