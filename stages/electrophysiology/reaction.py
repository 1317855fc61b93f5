"""Cells at the collocation points: recovery variable and active stress, by Runge-Kutta 4."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from stages.electrophysiology.cell_models.base import CellModel
from stages.electrophysiology.tension_laws.base import TensionLaw
from stages.numerics.compiled import inlined, kernel


def compile_reaction(cell_model: CellModel, tension_law: TensionLaw) -> Callable[..., None]:
    """Compiled advance of all cells over one time step.

    The returned kernel ``advance(v_old, v_new, w, sigma, ionic, crossing, start, step, threshold,
    cell, tension)`` works in place on arrays of shape ``(point,)``: it advances ``w`` and ``sigma``
    (eqs. 10, 11) over ``step`` with the potential running linearly from ``v_old`` to ``v_new``
    (frozen potentials would be first order only), writes I_ion/C_m at the new time into ``ionic``,
    and into ``crossing`` the time at which a potential rose through ``threshold``.
    """
    equations = sys.modules[type(cell_model).__module__]
    ionic_current = inlined(equations.ionic_current)
    recovery_rate = inlined(equations.recovery_rate)
    tension_rate = inlined(sys.modules[type(tension_law).__module__].tension_rate)

    @kernel
    def advance(
        v_old: Any,
        v_new: Any,
        w: Any,
        sigma: Any,
        ionic: Any,
        crossing: Any,
        start: float,
        step: float,
        threshold: float,
        cell: Any,
        tension: Any,
    ) -> None:
        half = 0.5 * step
        for i in range(v_old.size):
            v0, v1 = v_old[i], v_new[i]
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

    return advance
