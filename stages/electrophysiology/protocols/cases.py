"""Cases of a protocol: each is computed once, and borders between them are bisected."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from stages.numerics.bsplines import Array


class Cases:
    """Results by the number that tells the cases apart.

    Parameters
    ----------
    solve
        Computes the result of a case, shape ``(value,)``.
    told
        Called after each case that was computed.
    """

    def __init__(
        self, solve: Callable[[float], Array], told: Callable[[], None] = lambda: None
    ) -> None:
        self._solve, self._told = solve, told
        self._results: dict[float, Array] = {}

    def __call__(self, case: float) -> Array:
        """Result of a case, computed if it is not known yet."""
        if case not in self._results:
            self._results[case] = self._solve(case)
            self._told()
        return self._results[case]

    def __len__(self) -> int:
        return len(self._results)

    def sorted(self) -> tuple[Array, Array]:
        """Cases in ascending order, and their results, shape ``(case, value)``."""
        order = sorted(self._results)
        results = [self._results[case] for case in order]
        return np.array(order), np.array(results).reshape(len(order), -1 if order else 0)

    def arrays(self, name: str) -> dict[str, Array]:
        """Everything that a continuation needs, under names that begin with ``name``."""
        cases, results = self.sorted()
        return {f"{name}_cases": cases, f"{name}_results": results}

    def restore(self, name: str, saved: Mapping[str, Any]) -> None:
        """Know the results of :meth:`arrays` again; other entries of ``saved`` are ignored."""
        pairs = zip(saved[f"{name}_cases"], saved[f"{name}_results"], strict=True)
        self._results = {float(case): np.array(result) for case, result in pairs}


def bisections(at: Sequence[float], tolerance: float) -> int:
    """How many cases the bisection of one border takes at most.

    Examples
    --------
    >>> bisections([0.0, 1.0, 3.0], tolerance=0.5)
    2
    """
    widest = max((high - low for low, high in pairwise(at)), default=tolerance)
    return max(math.ceil(math.log2(widest / tolerance)), 0)


def refine_borders(
    at: Sequence[float], holds: Callable[[float], bool], tolerance: float
) -> Iterator[tuple[float, float]]:
    """Where a property begins or ceases to hold, to within a tolerance.

    Parameters
    ----------
    at
        Numbers to start from, ascending; between two neighbours at most one border is looked for.
    holds
        The property.
    tolerance
        Largest distance between the two numbers that enclose a border.

    Yields
    ------
    tuple
        The last number before each border and the first one behind it.

    Examples
    --------
    >>> list(refine_borders([0.0, 1.0, 2.0], lambda x: 0.3 < x < 1.3, 0.25))
    [(0.25, 0.5), (1.25, 1.5)]
    """
    for low, high in pairwise(at):
        first = holds(low)
        if holds(high) == first:
            continue
        while high - low > tolerance:
            middle = 0.5 * (low + high)
            if holds(middle) == first:
                low = middle
            else:
                high = middle
        yield low, high
