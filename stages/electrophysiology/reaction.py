"""Cells at the collocation points: recovery variable and active stress, by Runge-Kutta 4."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from typing import Any, NamedTuple, cast

from stages.electrophysiology.cell_models.base import CellModel
from stages.electrophysiology.tension_laws.base import TensionLaw
from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel


class Cells(NamedTuple):
    """Arrays of shape ``(point,)`` that the compiled loops advance in place.

    ``potential`` mV; ``recovery`` dimensionless; ``stress`` kPa; ``ionic`` I_ion/C_m at the newest
    level, mV/ms; ``crossing`` time of an upward crossing of the threshold, ms, else left as it is.
    """

    potential: Array
    recovery: Array
    stress: Array
    ionic: Array
    crossing: Array


def ionic_current_of(cell_model: CellModel) -> Callable[..., float]:
    """The function ``ionic_current(v, w, constants)`` beside a cell model's class."""
    return cast(Callable[..., float], sys.modules[type(cell_model).__module__].ionic_current)


class Clock(NamedTuple):
    """Time step (ms) and activation threshold (mV)."""

    step: float
    threshold: float


def compile_reaction(cell_model: CellModel, tension_law: TensionLaw) -> Callable[..., None]:
    """Compiled advance of all cells over one time step; compiled once per pair of models.

    The returned kernel ``advance(cells, new_potential, start, clock, cell, tension)`` works in place:
    it advances recovery and stress (eqs. 10, 11) from time ``start`` over one step with the potential
    running linearly from ``cells.potential`` to ``new_potential`` (a frozen one would be first order
    only), writes I_ion/C_m at the new time, notes crossings of the threshold, and takes over the new
    potential. ``cell`` and ``tension`` are the constants of the two models.
    """
    return _compile(
        ionic_current_of(cell_model),
        sys.modules[type(cell_model).__module__].recovery_rate,
        sys.modules[type(tension_law).__module__].tension_rate,
    )


@functools.cache
def _compile(
    current: Callable[..., float], recovery: Callable[..., float], tensing: Callable[..., float]
) -> Callable[..., None]:
    ionic_current, recovery_rate = inlined(current), inlined(recovery)
    tension_rate = inlined(tensing)

    @kernel
    def advance(
        cells: Any, new_potential: Any, start: float, clock: Any, cell: Any, tension: Any
    ) -> None:
        v_old, w, sigma, ionic, crossing = cells
        step, threshold = clock
        half = 0.5 * step
        for i in range(v_old.size):
            v0, v1 = v_old[i], new_potential[i]
            vm = 0.5 * (v0 + v1)
            w0, s0 = w[i], sigma[i]
            kw1 = recovery_rate(v0, w0, cell)
            ks1 = tension_rate(v0, w0, s0, tension)
            w1, s1 = w0 + half * kw1, s0 + half * ks1
            kw2 = recovery_rate(vm, w1, cell)
            ks2 = tension_rate(vm, w1, s1, tension)
            w2, s2 = w0 + half * kw2, s0 + half * ks2
            kw3 = recovery_rate(vm, w2, cell)
            ks3 = tension_rate(vm, w2, s2, tension)
            w3, s3 = w0 + step * kw3, s0 + step * ks3
            kw4 = recovery_rate(v1, w3, cell)
            ks4 = tension_rate(v1, w3, s3, tension)
            w_end = w0 + step / 6.0 * (kw1 + 2.0 * (kw2 + kw3) + kw4)
            w[i] = w_end
            sigma[i] = s0 + step / 6.0 * (ks1 + 2.0 * (ks2 + ks3) + ks4)
            ionic[i] = ionic_current(v1, w_end, cell)
            before = crossing[i]
            time = start + step * (threshold - v0) / (v1 - v0)
            crossing[i] = time if (v0 < threshold) & (v1 >= threshold) else before
            v_old[i] = v1

    return advance
