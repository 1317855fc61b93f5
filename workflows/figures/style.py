"""One look for all figures: sizes, colours, and files that do not change from run to run."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.rcsetup import cycler

from workflows.exports.files import replacing

PROBE_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito (2008): told apart with any colour vision, and in grey by their lightness."""

INK = "#222222"
FAINT = "#9a9a9a"

_SETTINGS: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.labelsize": 10,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.prop_cycle": cycler(color=PROBE_COLOURS),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "lines.solid_capstyle": "round",
    "svg.hashsalt": "myofilm",
    "svg.fonttype": "path",
}


@contextmanager
def drawing(width: float, height: float) -> Iterator[Figure]:
    """Figure of a size in inches, drawn in the common style."""
    with mpl.rc_context(_SETTINGS):
        figure = Figure(figsize=(width, height), dpi=160)
        FigureCanvasAgg(figure)
        yield figure


def save(figure: Figure, folder: Path, name: str) -> None:
    """Write ``name.png`` and ``name.svg``; the same data give the same bytes."""
    with replacing(folder / f"{name}.png") as path:
        figure.savefig(path, metadata={"Software": None})
    with replacing(folder / f"{name}.svg") as path:
        figure.savefig(path, metadata={"Date": None, "Creator": None})
