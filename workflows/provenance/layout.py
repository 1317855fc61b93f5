"""Places for the boxes and lines of a directed graph, in columns from what was made first to last.

The method of Sugiyama, Tagawa and Toda (1981): each box stands one column after the last one that it
was made from; a line across several columns has a place in each of those between; places within a
column follow the mean of their neighbours', which takes most crossings away.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Generic, TypeVar

T = TypeVar("T", bound=Hashable)

SWEEPS = 8
"""Passes to and fro over the columns; more change nothing in graphs of a few dozen boxes."""


@dataclass(frozen=True)
class Layout(Generic[T]):
    """Where things are, in columns and in units of height, y downwards.

    Attributes
    ----------
    columns
        Column of each box.
    heights
        Middle of each box.
    bends
        For each line, the middle of its place in each column between its ends.
    """

    columns: Mapping[T, int]
    heights: Mapping[T, float]
    bends: Mapping[tuple[T, T], tuple[float, ...]]


def layout(
    boxes: Sequence[T], lines: Sequence[tuple[T, T]], tall: Mapping[T, float], lane: float
) -> Layout[T]:
    """Layout of boxes and of the lines between them.

    Parameters
    ----------
    boxes
        What there is, each after all that lines lead from.
    lines
        Pairs: from, to.
    tall
        Height of each box, the gap to the next one included.
    lane
        Height for a line that passes a column.
    """
    columns: dict[T, int] = {}
    for box in boxes:
        before = (columns[start] for start, end in lines if end == box)
        columns[box] = 1 + max(before, default=-1)
    # A place is a box, or a line in one of the columns that it passes.
    rows: list[list[_Place]] = [[] for _ in range(1 + max(columns.values(), default=-1))]
    for box in boxes:
        rows[columns[box]].append((box, None))
    chains = {line: _chain(line, columns) for line in lines}
    for line, chain in chains.items():
        for column, place in enumerate(chain[1:-1], start=columns[line[0]] + 1):
            rows[column].append(place)
    size: dict[_Place, float] = {place: lane for row in rows for place in row}
    size |= {(box, None): tall[box] for box in boxes}
    near: dict[_Place, list[list[_Place]]] = {place: [[], []] for place in size}
    for chain in chains.values():
        for one, other in pairwise(chain):
            near[other][0].append(one)
            near[one][1].append(other)
    middle = _middles(rows, near, size)
    return Layout(
        columns,
        {box: middle[box, None] for box in boxes},
        {line: tuple(middle[place] for place in chain[1:-1]) for line, chain in chains.items()},
    )


_Place = tuple[Hashable, int | None]


def _chain(line: tuple[T, T], columns: Mapping[T, int]) -> list[_Place]:
    start, end = line
    between = range(columns[start] + 1, columns[end])
    return [(start, None), *((line, column) for column in between), (end, None)]


def _middles(
    rows: Sequence[list[_Place]],
    near: Mapping[_Place, list[list[_Place]]],
    size: Mapping[_Place, float],
) -> dict[_Place, float]:
    """Middle of each place: sorted by their neighbours' mean, then moved as near to it as they fit."""
    middle: dict[_Place, float] = {}
    for row in rows:
        middle |= _packed(row, [0.0] * len(row), size)
    for sweep in range(SWEEPS):
        forth = sweep % 2 == 0
        for row in rows if forth else reversed(rows):
            side = 0 if forth else 1
            wanted = {p: _mean([middle[n] for n in near[p][side]], middle[p]) for p in row}
            row.sort(key=lambda place: wanted[place])
            middle |= _packed(row, [wanted[place] for place in row], size)
    top = min((middle[p] - 0.5 * size[p] for p in middle), default=0.0)
    return {place: value - top for place, value in middle.items()}


def _mean(values: Sequence[float], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise


def _packed(
    row: Sequence[_Place], wanted: Sequence[float], size: Mapping[_Place, float]
) -> dict[_Place, float]:
    """Middles in the given order without overlap, with the least sum of squares from those wanted.

    Without the sizes that lie before each place this is a monotone regression: neighbours that are
    out of order are pooled at their mean.
    """
    starts, total = [], 0.0
    for place in row:
        starts.append(total + 0.5 * size[place])
        total += size[place]
    pools: list[list[float]] = []  # sum, count
    for want, start in zip(wanted, starts, strict=True):
        pools.append([want - start, 1.0])
        while len(pools) > 1 and pools[-2][0] / pools[-2][1] > pools[-1][0] / pools[-1][1]:
            last = pools.pop()
            pools[-1] = [pools[-1][0] + last[0], pools[-1][1] + last[1]]
    levels = [pool[0] / pool[1] for pool in pools for _ in range(int(pool[1]))]
    return {p: level + start for p, level, start in zip(row, levels, starts, strict=True)}
