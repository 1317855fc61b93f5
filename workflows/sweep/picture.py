"""Small multiples: every quantity over the parameters of a sweep, a panel each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from stages.numerics.bsplines import Array
from workflows.figures.style import INK, PROBE_COLOURS, drawing, save
from workflows.sweep.results import Column, Results
from workflows.tables import parameter

PANELS = 9
"""Quantities that are shown at most."""
ACROSS = 3
WIDTH, HEIGHT = 3.6, 2.7
"""Of a panel, inches."""

STYLES: tuple[Any, ...] = ("-", (0, (4, 2)), (0, (1, 1.5)), (0, (6, 2, 1, 2)))
LOOKS = ("full", "dashed", "dotted", "dash-dotted")
"""Lines for the values of a third parameter, and what they are called."""


def write_picture(results: Results, folder: Path) -> str:
    """Write ``cases.png`` and ``cases.svg``; what they show, in words."""
    columns, parameters = results.scalars(), results.parameters()
    shown = worth_showing(columns)
    grid = results.study.design.is_grid
    words = _lines(results, parameters, shown, folder) if grid else _dots(parameters, shown, folder)
    if len(shown) < len(columns):
        words += (
            f" Shown are {len(shown)} of {len(columns)} quantities, those that change; all are in "
            "cases.csv."
        )
    if any(column.place is not None for column in shown):
        words += " Of a quantity that is a list, the first item is shown."
    return words


def worth_showing(columns: Sequence[Column]) -> list[Column]:
    """The first quantities that change from case to case; if none does, the first ones.

    Single numbers come before first items of lists, which often say the same.
    """
    changing = [
        column
        for column in columns
        if column.is_numeric and _spread([x for x in column.numbers if math.isfinite(x)])
    ]
    found = changing or [column for column in columns if column.is_numeric]
    return sorted(found, key=lambda column: column.place is not None)[:PANELS]


def _spread(numbers: Sequence[float]) -> bool:
    """Whether numbers differ by more than rounding."""
    size = max(map(abs, numbers), default=0.0)
    return bool(numbers) and max(numbers) - min(numbers) > 1e-9 * size


def _lines(
    results: Results, parameters: Sequence[Column], shown: Sequence[Column], folder: Path
) -> str:
    """Curves over the parameter with the most values, coloured by the next one."""
    shape = results.study.design.shape
    order = sorted(range(len(shape)), key=lambda i: (not parameters[i].is_numeric, -shape[i]))
    along, *others = order
    coloured = others[0] if others else None
    styled = others[1] if len(others) > 1 and shape[others[1]] <= len(STYLES) else None
    x, labels = _positions(_axis(parameters[along], shape, along))
    order_along = np.argsort(x)
    x = x[order_along]
    with drawing(*_size(len(shown))) as figure:
        colours = _Colours(
            None if coloured is None else _axis(parameters[coloured], shape, coloured)
        )
        for axes, column in zip(_panels(figure, len(shown)), shown, strict=False):
            values = np.reshape(column.numbers, shape)
            curves = np.moveaxis(values, along, -1)[..., order_along]
            rest = [i for i in range(len(shape)) if i != along]
            for index in np.ndindex(*curves.shape[:-1]):
                level = index[rest.index(coloured)] if coloured is not None else 0
                style = STYLES[index[rest.index(styled)]] if styled is not None else "-"
                axes.plot(
                    x,
                    curves[index],
                    color=colours.of(level),
                    linestyle="" if labels else style,  # nothing lies between two names
                    linewidth=1.5,
                    marker="o" if labels or len(x) <= 25 else "",
                    markersize=5.0 if labels else 3.5,
                )
            axes.set_title(column.heading, fontsize=9, color=INK)
            _finish(axes, parameters[along], x, labels)
        _label_rows(figure, parameters[along])
        if coloured is not None:
            colours.explain(figure, parameters[coloured])
        _save(figure, folder)
    words = f"Each quantity over {_told(parameters[along])}"
    if coloured is not None:
        words += f", coloured by {_told(parameters[coloured])}"
    if styled is not None and not labels:
        lines = zip(_axis(parameters[styled], shape, styled).cells, LOOKS, strict=False)
        told = ", ".join(f"{look} for {parameter(cell)}" for cell, look in lines)
        words += f"; lines by {parameters[styled].name}: {told}"
        others = [i for i in others if i != styled]
    if more := [parameters[i].name for i in others[1:]]:
        words += f"; a curve for each value of {', '.join(more)}"
    return words + "."


def _dots(parameters: Sequence[Column], shown: Sequence[Column], folder: Path) -> str:
    """A row per quantity and a column per parameter: a dot for every case."""
    fields = list(parameters)[:4]
    shown = list(shown)[: max(PANELS // len(fields), 4)]
    with drawing(WIDTH * max(len(fields), 1), HEIGHT * max(len(shown), 1)) as figure:
        panels = figure.subplots(max(len(shown), 1), len(fields), squeeze=False)
        for row, column in zip(panels, shown, strict=False):
            for axes, field in zip(row, fields, strict=True):
                x, labels = _positions(field)
                axes.plot(x, column.numbers, "o", markersize=3.5, color=PROBE_COLOURS[0])
                _finish(axes, field, x, labels)
                axes.set_xlabel(_short(field), fontsize=9)
            row[0].set_ylabel(column.heading, fontsize=9)
        if not shown:
            _nothing(panels.flat)
        _save(figure, folder)
    return "Each quantity over each parameter, a dot per case."


class _Colours:
    """A colour for each value of a parameter: few are told apart, many run along a scale."""

    def __init__(self, values: Column | None) -> None:
        self._values = values
        count = 1 if values is None else len(values.cells)
        self._few = count <= len(PROBE_COLOURS) or (values is not None and not values.is_numeric)
        self._scale: Normalize | None = None
        if values is not None and not self._few:
            low, high = min(values.numbers), max(values.numbers)
            spaced = low > 0 and high > 100 * low
            self._scale = LogNorm(low, high) if spaced else Normalize(low, high)

    def of(self, level: int) -> Any:
        """Colour of the value at a place."""
        if self._scale is None or self._values is None:
            return PROBE_COLOURS[level % len(PROBE_COLOURS)]
        return mpl.colormaps["viridis"](self._scale(self._values.numbers[level]))

    def explain(self, figure: Figure, column: Column) -> None:
        """Add a legend, or the scale."""
        if self._values is None:
            return
        if self._scale is not None:
            mapped = mpl.cm.ScalarMappable(self._scale, "viridis")
            figure.colorbar(mapped, ax=figure.axes, label=_short(column), shrink=0.8)
            return
        entries = [
            Line2D([], [], color=self.of(i), label=parameter(cell))
            for i, cell in enumerate(self._values.cells)
        ]
        figure.legend(
            handles=entries,
            title=_short(column),
            loc="outside upper center",
            ncols=min(len(entries), 8),
        )


def _axis(column: Column, shape: Sequence[int], place: int) -> Column:
    """The values of a swept parameter, each once."""
    index: list[Any] = [0] * len(shape)
    index[place] = slice(None)
    numbers = np.reshape(np.arange(len(column.cells)), shape)[tuple(index)]
    return Column(column.name, column.unit, [column.cells[i] for i in numbers], column.meaning)


def _positions(column: Column) -> tuple[Array, list[str] | None]:
    """Places along an axis; texts stand one beside the other, with labels."""
    if column.is_numeric:
        return np.array(column.numbers), None
    words = [parameter(cell) for cell in column.cells]
    order = list(dict.fromkeys(words))
    return np.array([float(order.index(word)) for word in words]), order


def _size(panels: int) -> tuple[float, float]:
    across = min(max(panels, 1), ACROSS)
    return WIDTH * max(across, 1.5), HEIGHT * math.ceil(max(panels, 1) / ACROSS) + 0.6


def _panels(figure: Figure, count: int) -> list[Axes]:
    across = min(max(count, 1), ACROSS)
    panels = figure.subplots(math.ceil(max(count, 1) / ACROSS), across, squeeze=False)
    for unused in panels.flat[count:]:
        unused.set_axis_off()
    if not count:
        _nothing(panels.flat)
    return list(panels.flat[:count])


def _nothing(panels: Any) -> None:
    for axes in panels:
        axes.set_axis_off()
        axes.text(0.5, 0.5, "no case is done", ha="center", va="center", color=INK)


def _finish(axes: Axes, along: Column, x: Array, labels: list[str] | None) -> None:
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.margins(x=0.04 if labels is None else 0.2)
    axes.tick_params(labelsize=8)
    if labels is not None:
        long = sum(map(len, labels)) > 30
        look: Any = {"rotation": 20, "ha": "right"} if long else {}
        axes.set_xticks(range(len(labels)), labels, **look)
    elif len(x) > 2 and x.min() > 0 and x.max() > 100 * x.min():
        axes.set_xscale("log")
    else:
        axes.xaxis.set_major_locator(MaxNLocator(5))


def _label_rows(figure: Figure, along: Column) -> None:
    for axes in figure.axes:
        if axes.axison:
            axes.set_xlabel(_short(along), fontsize=9)


def _short(column: Column) -> str:
    name = ".".join(column.name.split(".")[-2:])
    return name if column.unit in ("", "1") else f"{name} [{column.unit}]"


def _told(column: Column) -> str:
    return f"{column.name} ({column.meaning})" if column.meaning else column.name


def _save(figure: Figure, folder: Path) -> None:
    figure.set_layout_engine("constrained")
    save(figure, folder, "cases")
