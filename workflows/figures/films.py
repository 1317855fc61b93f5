"""Several deformed films in one figure, on one scale, each coloured by a field."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from mpl_toolkits.mplot3d import Axes3D  # type: ignore[import-untyped]  # ships no types

from stages.numerics.bsplines import Array
from workflows.figures.style import FAINT, INK, drawing, save

COLOURS = colormaps["viridis"]
QUADS_ALONG = 96
ELEVATION = 24
"""Degrees from which one looks down on the films."""


@dataclass(frozen=True)
class Panel:
    """One film.

    Attributes
    ----------
    title
        What stands above it.
    reference, shape
        Points at rest and now, mm, shape ``(n1, n2, 3)``.
    field
        What colours it, shape ``(n1, n2)``.
    held
        Word for every edge that is held.
    """

    title: str
    reference: Array
    shape: Array
    field: Array
    held: Mapping[str, str]


def draw_films(
    panels: Sequence[Panel], scale: Normalize, label: str, folder: Path, name: str
) -> None:
    """Write ``name.png`` and ``name.svg``: rows of films, with a bar of their colours."""
    box = _common_box([points for panel in panels for points in (panel.reference, panel.shape)])
    columns, room = 3 if len(panels) <= 6 else 4, _room(box)
    rows = -(-len(panels) // columns)
    with drawing(1.1 + 3.1 * columns, 0.2 + 2.4 * room * rows) as figure:
        for i, panel in enumerate(panels):
            axes = figure.add_subplot(rows, columns, i + 1, projection="3d", computed_zorder=False)
            _draw_film(axes, panel, scale, box, 1.04 / room)
            if i == 0:
                _draw_measures(axes, panel)
            axes.set_title(f"({'abcdefghijkl'[i]})  {panel.title}", y=0.9, color=INK)
        figure.subplots_adjust(left=0.0, right=0.9, bottom=0.0, top=1.0, wspace=0.0, hspace=0.0)
        bar = figure.add_axes((0.925, 0.2, 0.014, 0.6))
        lowest = min(float(panel.field.min()) for panel in panels)
        highest = max(float(panel.field.max()) for panel in panels)
        beyond = (lowest < (scale.vmin or 0.0), highest > (scale.vmax or 0.0))
        extend = {(True, True): "both", (True, False): "min", (False, True): "max"}
        figure.colorbar(
            ScalarMappable(scale, COLOURS),
            cax=bar,
            label=label,
            extend=extend.get(beyond, "neither"),
        )
        save(figure, folder, name)


def _draw_film(
    axes: Axes3D, panel: Panel, scale: Normalize, box: tuple[Array, Array], zoom: float
) -> None:
    reference, shape, field = panel.reference, panel.shape, panel.field
    sides = (reference[:, 0], reference[-1], reference[::-1, -1], reference[0, ::-1])
    at_rest = np.concatenate(sides)
    axes.plot(*at_rest.T, color=FAINT, lw=0.7, linestyle=(0, (4, 3)), zorder=1, clip_on=False)
    middle = (field[:-1, :-1] + field[1:, :-1] + field[1:, 1:] + field[:-1, 1:]) / 4
    film = axes.plot_surface(
        *np.moveaxis(shape, -1, 0),
        facecolors=COLOURS(scale(middle)),
        rstride=1,
        cstride=1,
        shade=False,
        linewidth=0,
        antialiased=False,
        zorder=2,
    )
    film.set_rasterized(True)
    film.set_clip_on(False)
    edges = {"X=0": shape[0], "X=L1": shape[-1], "Y=0": shape[:, 0], "Y=L2": shape[:, -1]}
    for name, edge in edges.items():
        width = 3.0 if name in panel.held else 0.8
        axes.plot(*edge.T, color=INK, lw=width, zorder=3, clip_on=False)
    low, high = box
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    # A box is drawn with a fixed diagonal; the zoom undoes that, so that all films are equally long.
    size = high - low
    axes.set_box_aspect(size, zoom=zoom * np.linalg.norm(size) / np.linalg.norm(size[:2]))
    axes.view_init(elev=ELEVATION, azim=-62)
    axes.set_axis_off()


def _draw_measures(axes: Axes3D, panel: Panel) -> None:
    """Directions, a length of 1 mm, and how edges are held, beside and below the film at rest."""
    corner, far = panel.reference.min(axis=(0, 1)), panel.reference.max(axis=(0, 1))
    bar = corner + np.array([[0.0, -0.3, 0.0], [1.0, -0.3, 0.0]])
    axes.plot(*bar.T, color=INK, lw=1.6, clip_on=False)
    look = {"color": INK, "fontsize": 9, "ha": "center", "va": "center"}
    middle = 0.5 * (corner + far)
    axes.text(corner[0] + 0.6, corner[1] - 0.58, corner[2], "1 mm", **look)
    axes.text(middle[0] + 0.5, corner[1] - 0.35, corner[2], "$X$", **look)
    axes.text(far[0] + 0.3, middle[1], far[2], "$Y$", **look)
    aside = min(0.45, 0.225 * float(far[1] - corner[1]))
    beside = {
        "X=0": (corner[0] - 0.6, middle[1] + aside),
        "X=L1": (far[0] + 0.6, middle[1] - aside),
        "Y=0": (middle[0] - 0.3, corner[1] - 0.6),
        "Y=L2": (middle[0], far[1] + 0.4),
    }
    for edge, word in panel.held.items():
        axes.text(*beside[edge], corner[2], word, **look)


def _room(box: tuple[Array, Array]) -> float:
    """How much higher than usual the panels must be, so that no film reaches into its title."""
    size, angle = box[1] - box[0], np.deg2rad(ELEVATION)
    floor = float(np.linalg.norm(size[:2]))
    return max(1.0, float(size[2] * np.cos(angle) + floor * np.sin(angle)) / (0.72 * floor))


def _common_box(shapes: list[Array]) -> tuple[Array, Array]:
    """Corners of a box that holds all shapes, a little wider, so that all panels share one scale."""
    points = np.concatenate([shape.reshape(-1, 3) for shape in shapes])
    low, high = points.min(axis=0), points.max(axis=0)
    margin = 0.02 * float((high - low).max())
    return low - margin, high + margin
