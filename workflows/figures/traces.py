"""Active stress and displacement at two probes over time, in the layouts of Figs 9 and 11."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from stages.artefacts import Measures
from workflows.experiment import Experiment
from workflows.figures.style import INK, PROBE_COLOURS, drawing, save

PAPER_PROBES = {"fig9": ("A", "B"), "fig11": ("A", "C")}
"""Where the paper looks: at the centre and the tip, at the centre and the corner."""

LINE_STYLES: tuple[Any, ...] = ("-", (0, (4, 2.5)))


def write(experiment: Experiment, folder: Path, name: str) -> None:
    """Write ``name.png`` and ``name.svg`` for one run."""
    draw({"": experiment.measures}, folder, name)


def draw(runs: Mapping[str, Measures], folder: Path, name: str) -> None:
    """Write the figure for one run, or for several laid over one another, labelled by their names."""
    first = next(iter(runs.values()))
    probes = [probe for probe in PAPER_PROBES[name] if probe in first.probe_names]
    probes = probes or list(first.probe_names[:2])
    with drawing(10.4, 3.9) as figure:
        stress, motion = figure.subplots(1, 2)
        for run, measures in enumerate(runs.values()):
            _draw_run(stress, motion, measures, probes, LINE_STYLES[run % 2], first=run == 0)
        stress.set_ylabel(r"active stress $\sigma_a$ [kPa]")
        motion.set_ylabel(r"displacement magnitude $|u|$ [mm]")
        for letter, axes in zip("ab", (stress, motion), strict=True):
            axes.set_title(f"({letter})", loc="left", color=INK)
            axes.set_xlabel("time $t$ [ms]")
            axes.set_xlim(first.time[0], first.time[-1])
            axes.set_ylim(bottom=0)
            axes.grid(alpha=0.25, linewidth=0.6)
        entries = _legend(probes, first, list(runs))
        figure.legend(handles=entries, loc="upper center", ncols=len(entries))
        figure.tight_layout(w_pad=3, rect=(0, 0, 1, 0.93))
        save(figure, folder, name)


def _draw_run(
    stress: Axes,
    motion: Axes,
    measures: Measures,
    probes: list[str],
    line: Any,
    *,
    first: bool,
) -> None:
    for colour, name in zip(PROBE_COLOURS, probes, strict=False):
        probe = measures.probe_names.index(name)
        size = np.linalg.norm(measures.displacement[:, probe], axis=1)
        look: dict[str, Any] = {"color": colour, "linestyle": line, "zorder": 3 if first else 2}
        stress.plot(measures.time, measures.active_stress[:, probe], **look)
        motion.plot(measures.time, size, **look)


def _legend(probes: list[str], measures: Measures, labels: list[str]) -> list[Line2D]:
    """One entry per probe with its place, then one per run with its line."""
    entries = []
    for colour, name in zip(PROBE_COLOURS, probes, strict=False):
        x, y, _ = measures.probe_points[measures.probe_names.index(name)]
        entries.append(Line2D([], [], color=colour, label=f"{name}: X = {x:g}, Y = {y:g} mm"))
    if len(labels) > 1:
        for run, label in enumerate(labels):
            entries.append(Line2D([], [], color=INK, linestyle=LINE_STYLES[run % 2], label=label))
    return entries
