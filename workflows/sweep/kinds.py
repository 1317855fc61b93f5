"""Warnings of one kind: those that differ in numbers only."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"\d+(\.\d+)?(e[+-]?\d+)?")


def kind_of(warning: str) -> str:
    """What warnings of one kind have in common.

    Examples
    --------
    >>> kind_of("step 22 (to t = 2.5e-3 ms)"), kind_of("step 7 (to t = 40 ms)")
    ('step # (to t = # ms)', 'step # (to t = # ms)')
    """
    return _NUMBER.sub("#", warning)
