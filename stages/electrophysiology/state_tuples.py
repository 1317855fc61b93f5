"""Arithmetic on the states of one cell: tuples of floats whose length is known when compiled.

Each function is built by recursion over closures, one variable at a time, so that the compiler sees
plain scalars; a loop over the entries would keep the loop over cells from becoming SIMD code.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

from stages.numerics.compiled import inlined

States = tuple[float, ...]


class TupleFunctions(NamedTuple):
    """Compiled functions for tuples of one length.

    ``load(states, i)`` reads column i of an array of shape ``(variable, point)``, ``store(states, i, s)``
    writes it; ``moved(s, h, k)`` is s + h k; ``weighted(s, h, k1, k2, k3, k4)`` is the end of a
    Runge-Kutta step, s + h/6 (k1 + 2 (k2 + k3) + k4).
    """

    load: Callable[..., States]
    store: Callable[..., None]
    moved: Callable[..., States]
    weighted: Callable[..., States]


@functools.cache
def tuple_functions(length: int) -> TupleFunctions:
    """The functions for tuples of ``length`` floats; zero is a length, too."""
    if length == 0:
        return TupleFunctions(
            inlined(_no_load), inlined(_no_store), inlined(_no_move), inlined(_no_weights)
        )
    rest, last = tuple_functions(length - 1), length - 1
    load_rest, store_rest, moved_rest, weighted_rest = rest

    @inlined
    def load(states: Any, i: int) -> States:
        return (*load_rest(states, i), states[last, i])

    @inlined
    def store(states: Any, i: int, s: States) -> None:
        store_rest(states, i, s)
        states[last, i] = s[last]

    @inlined
    def moved(s: States, h: float, k: States) -> States:
        return (*moved_rest(s, h, k), s[last] + h * k[last])

    @inlined
    def weighted(s: States, h: float, k1: States, k2: States, k3: States, k4: States) -> States:
        slope = k1[last] + 2.0 * (k2[last] + k3[last]) + k4[last]
        return (*weighted_rest(s, h, k1, k2, k3, k4), s[last] + h / 6.0 * slope)

    return TupleFunctions(load, store, moved, weighted)


def _no_load(states: Any, i: int) -> States:
    return ()


def _no_store(states: Any, i: int, s: States) -> None:
    return None


def _no_move(s: States, h: float, k: States) -> States:
    return ()


def _no_weights(s: States, h: float, k1: States, k2: States, k3: States, k4: States) -> States:
    return ()
