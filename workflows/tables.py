"""Numbers and tables as plain text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any


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
