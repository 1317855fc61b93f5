"""Duration, force and speed of beats by the time that the tissue has rested."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from stages.paced_artefacts import PacedBeats, Restitution
from workflows.experiment import Experiment
from workflows.figures.style import INK, PROBE_COLOURS, drawing, save

TRACES = 8
"""Beats drawn over time, spread over the cases; more cannot be told apart."""


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``restitution.png`` and ``restitution.svg``."""
    measured: Restitution = experiment.load("restitution")
    has_speed = bool(np.isfinite(measured.s2.conduction_velocity).any())
    rows, columns = (2, 2) if has_speed else (1, 3)
    with drawing(10.4 if has_speed else 13.5, 7.4 if has_speed else 3.9) as figure:
        panels = list(np.ravel(figure.subplots(rows, columns)))
        _draw_durations(panels[0], measured)
        _draw(panels[1], measured, "peak_active_stress", r"peak active stress $\sigma_a$ [kPa]")
        panels[1].set_ylim(bottom=0)
        if has_speed:
            _draw(panels[2], measured, "conduction_velocity", "speed of the wave [mm/ms]")
        _draw_traces(panels[-1], measured)
        for letter, axes in zip("abcd", panels, strict=False):
            axes.set_title(f"({letter})", loc="left", color=INK)
            axes.grid(alpha=0.25, linewidth=0.6)
        for axes in panels[:-1]:
            axes.set_xlabel("diastolic interval [ms]")
        figure.tight_layout(w_pad=3, h_pad=2)
        save(figure, folder, "restitution")


def _draw_durations(axes: Axes, measured: Restitution) -> None:
    _draw(axes, measured, "apd90", "duration of the action potential [ms]", " APD90")
    rest, short = measured.s2.diastolic_interval, measured.s2.apd50
    axes.plot(rest, short, color=PROBE_COLOURS[2], marker="o", ms=4, label="S2, APD50")
    axes.set_ylim(bottom=0)
    axes.legend()


def _draw(axes: Axes, measured: Restitution, name: str, label: str, what: str = "") -> None:
    drawn = (
        (measured.s2, "S2", PROBE_COLOURS[0], "o", "-"),
        (measured.steady, "steady train", PROBE_COLOURS[1], "s", "--"),
    )
    for beats, about, colour, marker, line in drawn:
        rest, values = beats.diastolic_interval, getattr(beats, name)
        if np.isfinite(values).any():
            text = f"{about},{what}" if what else about
            axes.plot(rest, values, color=colour, label=text, marker=marker, ms=4, ls=line)
    axes.set_ylabel(label)
    if not what and axes.get_lines():
        axes.legend()


def _draw_traces(axes: Axes, measured: Restitution) -> None:
    """Potential after S2, for some cases from the shortest interval to the longest."""
    beats: PacedBeats = measured.s2
    made = np.flatnonzero(np.isfinite(beats.activation_time))
    count = min(TRACES, made.size)
    chosen = made[np.unique(np.linspace(0, made.size - 1, count).round().astype(int))]
    colours = colormaps["viridis"](np.linspace(0.0, 0.85, max(chosen.size, 1)))
    for case, colour in zip(chosen, colours, strict=False):
        interval = f"{beats.interval[case]:g} ms"
        axes.plot(measured.sample_times, beats.potential[case], color=colour, label=interval)
    axes.set_xlabel("time since S2 [ms]")
    axes.set_ylabel("potential $v$ [mV]")
    if axes.get_lines():
        axes.legend(title="S1 to S2", fontsize=8)
