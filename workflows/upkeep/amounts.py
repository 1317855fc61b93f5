"""Times and sizes as people write them."""

from __future__ import annotations

import math
import re

from pipeline.errors import InputError

TIMES = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0, "w": 604800.0}
"""Seconds of the units of time."""

SIZES = {"B": 1.0, "kB": 1e3, "MB": 1e6, "GB": 1e9, "TB": 1e12, "MiB": 2.0**20, "GiB": 2.0**30}
"""Bytes of the units of size."""


def seconds_of(text: str) -> float:
    """Seconds of a time with its unit.

    Raises
    ------
    InputError
        If it is none.

    Examples
    --------
    >>> seconds_of("30d"), seconds_of("1.5 h")
    (2592000.0, 5400.0)
    """
    return _amount(text, TIMES, "a time", "30d, 12h")


def bytes_of(text: str) -> int:
    """Bytes of a size with its unit.

    Raises
    ------
    InputError
        If it is none.

    Examples
    --------
    >>> bytes_of("10GB"), bytes_of("1.5 MiB")
    (10000000000, 1572864)
    """
    return round(_amount(text, SIZES, "a size", "10GB, 500MB"))


def ago(seconds: float) -> str:
    """A time since then in its largest unit.

    Examples
    --------
    >>> ago(-3), ago(42.3), ago(200), ago(7300), ago(200_000), ago(90 * 86400)
    ('0 s', '42 s', '3 min', '2 h', '2 d', '90 d')
    """
    for unit, length, end in (("s", 1, 60), ("min", 60, 3600), ("h", 3600, 86400)):
        if seconds < end:
            return f"{max(seconds, 0) // length:.0f} {unit}"
    return f"{seconds // 86400:.0f} d"


def _amount(text: str, units: dict[str, float], kind: str, examples: str) -> float:
    match = re.fullmatch(r"\s*([0-9]*\.?[0-9]+(?:[eE][+-]?[0-9]+)?)\s*([A-Za-z]+)\s*", text)
    if match is None or match[2] not in units or not math.isfinite(float(match[1])):
        raise InputError(
            f"{text!r} is not {kind}: give a number and one of {', '.join(units)} (as {examples})"
        )
    return float(match[1]) * units[match[2]]
