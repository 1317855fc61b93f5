"""Finds states that are no finite numbers, cheaply enough for every step."""

from __future__ import annotations

from typing import Any

import numpy as np

from stages.electrophysiology.reaction import Cells
from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel

LARGEST = float(np.finfo(np.float32).max)
"""Frames are stored in single precision: larger numbers are infinite there."""


@inlined
def _bad(values: Array) -> int:
    """How many values are NaN or too large; a sum of integers, so that the loop becomes SIMD code."""
    count = 0
    for i in range(values.size):
        count += 0 if abs(values[i]) <= LARGEST else 1
    return count


@kernel
def any_bad(cells: Any) -> bool:
    """Whether a potential, a state or a stress is no finite number."""
    bad = _bad(cells.potential) + _bad(cells.stress)
    for variable in range(cells.states.shape[0]):
        bad += _bad(cells.states[variable])
    return bad > 0


def first_bad(cells: Cells) -> int:
    """Number of the first point with such a value, -1 if there is none."""
    rows = (cells.potential, cells.stress, *cells.states)
    found = np.flatnonzero(~np.all([np.abs(row) <= LARGEST for row in rows], axis=0))
    return int(found[0]) if found.size else -1
