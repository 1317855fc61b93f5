"""Maps of every beat on the flat film: isochrones with velocities, and durations."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from stages.numerics.bsplines import Array
from stages.numerics.film_lengths import FilmLengths
from workflows.experiment import Experiment
from workflows.figures.films import COLOURS
from workflows.figures.style import INK, drawing, save

MOST = 4
"""Beats that are drawn."""

FEWEST = 0.02
"""A beat is drawn if this share of the points has it."""

JUMP = 50.0
"""ms; no front is so slow between two neighbours: there, the points' beats belong to different waves."""

SPACINGS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Between isochrones, ms."""

ARROWS = 11
"""Along X."""


def write(experiment: Experiment, folder: Path) -> None:
    """Write ``activation_maps.png`` and ``activation_maps.svg``: a row per beat."""
    patch, history = experiment.geometry.excitable_surface.patch, experiment.history
    grid = FilmLengths(patch).grid()
    shape = (patch.first.size, patch.second.size)
    times = np.asarray(history.activation_times).reshape(*shape, -1)
    beats = [b for b in range(times.shape[2]) if np.isfinite(times[..., b]).mean() >= FEWEST][:MOST]
    durations = np.asarray(history.apd90).reshape(*shape, -1)[..., beats]
    velocity = _in_the_film(patch, np.asarray(history.conduction_velocity)).reshape(*shape, -1, 2)
    rows = max(len(beats), 1)
    with drawing(10.4, 0.3 + rows * (0.5 + 4.1 * grid[1][-1] / grid[0][-1])) as figure:
        both = figure.subplots(rows, 2, sharex=True, sharey=True, squeeze=False)
        for row, beat in enumerate(beats):
            left, right = both[row]
            _draw_arrivals(figure, left, grid, times[..., beat])
            _draw_arrows(left, grid, velocity[..., beat, :])
            scale = _scale(durations[..., row])
            right.pcolormesh(
                *grid, durations[..., row].T, norm=scale, cmap=COLOURS, rasterized=True
            )
            bar = ScalarMappable(scale, COLOURS)
            figure.colorbar(bar, ax=right, label="APD90 [ms]", extend="both", shrink=0.8)
            left.set_title(f"({'abcd'[row]})  beat {beat + 1}", loc="left", color=INK)
        for axes in both.flat:
            axes.set_aspect("equal")
            axes.set(xlim=grid[0][[0, -1]], ylim=grid[1][[0, -1]])
        for axes in both[:, 0]:
            axes.set_ylabel("$Y$ [mm]")
        for axes in both[-1]:
            axes.set_xlabel("$X$ [mm]")
        figure.tight_layout(h_pad=0.6, w_pad=1.5)
        save(figure, folder, "activation_maps")


def _draw_arrivals(figure: Figure, axes: Axes, grid: tuple[Array, Array], times: Array) -> None:
    """Colours and lines of equal activation time; no line where two waves adjoin."""
    scale = _scale(times)
    picture = axes.pcolormesh(*grid, times.T, norm=scale, cmap=COLOURS, rasterized=True)
    figure.colorbar(picture, ax=axes, label="activation [ms]", extend="both", shrink=0.8)
    low, high = float(scale.vmin or 0.0), float(scale.vmax or 0.0)
    spacing = next((s for s in SPACINGS if high - low <= 25 * s), 10.0 * SPACINGS[-1])
    levels = np.arange(np.floor(low / spacing), np.ceil(high / spacing) + 1.0) * spacing
    lines = np.where(_beside_a_jump(times), np.nan, times)
    if np.isfinite(lines).any():
        axes.contour(*grid, lines.T, levels=levels, colors="white", linewidths=0.6)
    axes.set_title(f"lines: {spacing:g} ms", loc="right", color=INK, fontsize=9)


def _beside_a_jump(times: Array) -> Any:
    beside = np.zeros(times.shape, dtype=bool)
    for axis in (0, 1):
        jump = np.moveaxis(np.abs(np.diff(times, axis=axis)) > JUMP, axis, 0)
        marked = np.moveaxis(beside, axis, 0)
        marked[1:] |= jump
        marked[:-1] |= jump
    return beside


def _draw_arrows(axes: Axes, grid: tuple[Array, Array], velocity: Array) -> None:
    """Velocities at a few points, all on one scale of speed."""
    length, width = grid[0][-1], grid[1][-1]
    at = [
        np.unique(np.searchsorted(g, (np.arange(n) + 0.5) * g[-1] / n))
        for g, n in zip(grid, (ARROWS, max(round(ARROWS * width / length), 2)), strict=True)
    ]
    chosen = velocity[np.ix_(*at)]
    speed = np.linalg.norm(chosen, axis=-1)
    usual = np.median(speed[np.isfinite(speed)]) if np.isfinite(speed).any() else 1.0
    chosen = chosen * np.minimum(1.0, 2.0 * usual / speed)[..., None]  # beside collisions: cut
    x, y = np.meshgrid(grid[0][at[0]], grid[1][at[1]], indexing="ij")
    axes.quiver(
        x, y, *np.moveaxis(chosen, -1, 0), color=INK, angles="xy", scale_units="xy",
        scale=usual * ARROWS / (0.7 * length), width=0.006, pivot="mid",
    )  # fmt: skip


def _in_the_film(patch: Any, velocity: Array) -> Array:
    """Components along the two parametric directions, shape ``(point, beat, 2)``."""
    at = patch.first.greville(), patch.second.greville()
    sides = [patch.evaluate(*at, orders) for orders in ((1, 0), (0, 1))]
    units = np.stack([side / np.linalg.norm(side, axis=1, keepdims=True) for side in sides])
    return np.asarray(np.einsum("pbx,dpx->pbd", velocity, units))


def _scale(values: Array) -> Normalize:
    """From the smallest to the largest but for outliers."""
    seen = values[np.isfinite(values)]
    if not seen.size:
        return Normalize(0.0, 1.0)
    low, high = np.percentile(seen, (1, 99))
    return Normalize(low, high + 1e-9)
