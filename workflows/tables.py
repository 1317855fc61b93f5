"""Numbers and tables as plain text."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

READABLE = 24
"""Characters that a column of prose needs at least."""


def number(value: Any) -> str:
    """A value as people write it.

    Examples
    --------
    >>> number(0.017431234), number([101.98, 569.0]), number(None), number((50, 10)), number("S1")
    ('0.01743', '102, 569', '-', '50, 10', 'S1')
    >>> number(100000), number(True), number([])
    ('100000', 'yes', '-')
    """
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list | tuple):
        return ", ".join(number(item) for item in value) or "-"
    return str(value)


def exact(value: float) -> str:
    """A number with all digits it takes to tell it from its neighbours.

    Examples
    --------
    >>> exact(3.5), exact(1.0), exact(3.5000000000000004)
    ('3.5', '1', '3.5000000000000004')
    """
    return repr(float(value)).removesuffix(".0")


def parameter(value: Any) -> str:
    """A parameter as it may be typed in again.

    Examples
    --------
    >>> parameter(0.018), parameter(2000.0), parameter((102, 60)), parameter("clamped")
    ('0.018', '2000', '[102, 60]', 'clamped')
    """
    if isinstance(value, float):
        return f"{value:.15g}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(parameter(item) for item in value)}]"
    return number(value)


def aligned(rows: Sequence[Sequence[str]], indent: str = "") -> Iterator[str]:
    """Lines of a table whose columns start below one another.

    Examples
    --------
    >>> list(aligned([("a", "1"), ("long", "22")], indent="  "))
    ['  a     1', '  long  22']
    """
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    for row in rows:
        cells = [cell.ljust(width) for cell, width in zip(row, widths, strict=True)]
        yield (indent + "  ".join(cells)).rstrip()


def fitted(rows: Sequence[Sequence[str]], width: int) -> Iterator[str]:
    """The same lines for a terminal so wide: the last column is wrapped.

    Where it would have no room, each row becomes a paragraph.

    Examples
    --------
    >>> rows = [("geometry.length", "3.5", "mm", "length of the film along X")]
    >>> for line in fitted(rows, 50): print(line)
    geometry.length  3.5  mm  length of the film along
                              X
    >>> for line in fitted(rows, 29): print(line)
    geometry.length  3.5  mm
        length of the film along
        X
    """
    indent, gap = " " * 4, "  "
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    start = sum(width + len(gap) for width in widths[:-1])
    for *cells, prose in rows:
        if width - start >= READABLE:
            first, *more = _wrap(prose, width - start) or [""]
            padded = (cell.ljust(width) for cell, width in zip(cells, widths, strict=False))
            yield gap.join([*padded, first]).rstrip()
            yield from (" " * start + line for line in more)
        else:
            short = gap.join(cell for cell in cells if cell)
            first, *more = [*_wrap(short, width - len(indent)), *_wrap(prose, width - len(indent))]
            yield first
            yield from (indent + line for line in more)


def _wrap(text: str, width: int) -> list[str]:
    return textwrap.wrap(text, width, break_on_hyphens=False)
