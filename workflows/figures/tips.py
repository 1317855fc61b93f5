"""Path of a spiral's tip over the film, and how long its turns take."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator

from stages.artefacts import Measures
from stages.postprocessing.tip_paths import turn_times
from workflows.experiment import Experiment
from workflows.figures.style import FAINT, INK, PROBE_COLOURS, drawing, save
from workflows.film_quantities import listed
from workflows.rotation import pulses
from workflows.rotation import turn_times as turns_at

COLOURS = colormaps["viridis"]


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``tips.png`` and ``tips.svg``."""
    measures = experiment.measures
    film = experiment.geometry.mid_surface.patch
    edges = np.linspace(0.0, 1.0, 41)
    outline = film.evaluate_points(
        np.concatenate(
            [
                np.column_stack((edges, 0 * edges)),
                np.column_stack((0 * edges + 1, edges)),
                np.column_stack((edges[::-1], 0 * edges + 1)),
                np.column_stack((0 * edges, edges[::-1])),
            ]
        )
    )
    with drawing(10.4, 3.9) as figure:
        place, turns = figure.subplots(1, 2, width_ratios=(1.5, 1.0))
        place.plot(outline[:, 0], outline[:, 1], color=INK, lw=0.8)
        seen = measures.tips.time if measures.tips.time.size else measures.time
        scale = Normalize(seen.min(), seen.max())
        _draw_paths(place, measures, scale)
        for name, point in zip(measures.probe_names, measures.probe_points, strict=True):
            place.plot(*point[:2], color=FAINT, marker="+", ms=8, clip_on=False)
            place.annotate(name, point[:2], (4, 4), textcoords="offset points", color=FAINT)
        place.set(aspect="equal", xlabel="$X$ [mm]", ylabel="$Y$ [mm]")
        figure.colorbar(ScalarMappable(scale, COLOURS), ax=place, label="time [ms]", shrink=0.8)
        _draw_turns(turns, measures, pulses(experiment.config.electrophysiology))
        for letter, axes in zip("ab", (place, turns), strict=True):
            axes.set_title(f"({letter})", loc="left", color=INK)
        figure.tight_layout(w_pad=2)
        save(figure, folder, "tips")


def _draw_paths(axes: Axes, measures: Measures, scale: Normalize) -> None:
    """One line per tip, coloured by time, with a dot where it was seen last."""
    tips = measures.tips
    if not tips.number.size:
        axes.text(
            0.5, 0.5, "no tip", transform=axes.transAxes, ha="center", va="center", color=FAINT
        )
    for number in np.unique(tips.number):
        rows = np.flatnonzero(tips.number == number)
        for i, k in pairwise(rows):
            colour = COLOURS(scale(tips.time[i]))
            axes.plot(tips.position[[i, k], 0], tips.position[[i, k], 1], color=colour, lw=1.2)
        axes.plot(*tips.position[rows[-1], :2], color=INK, marker="o", ms=4)


def _draw_turns(axes: Axes, measures: Measures, stimuli: int) -> None:
    """Length of each turn: of the tip, and as the probes see it."""
    series = [("tip", list(turn_times(measures.tips)))]
    for name, times in zip(measures.probe_names, measures.activation_times, strict=True):
        arrivals = [time for time in listed(times) if time is not None]
        series.append((name, turns_at(arrivals, stimuli)))
    colours = (INK, *PROBE_COLOURS)
    for k, (name, turns) in enumerate(series):
        if turns:
            numbers = np.arange(1, len(turns) + 1)
            axes.plot(numbers, turns, color=colours[k % len(colours)], marker="o", ms=4, label=name)
    axes.set(xlabel="turn", ylabel="length of the turn [ms]")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.grid(alpha=0.25, linewidth=0.6)
    if axes.get_lines():
        axes.legend()
