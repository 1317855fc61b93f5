"""Cells at the collocation points: their states and active stress in time, by Runge-Kutta 4."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

from stages.electrophysiology.cell_models.base import CellModel, equations_of
from stages.electrophysiology.state_tuples import tuple_functions
from stages.electrophysiology.tension_laws.base import TensionLaw, equation_of
from stages.numerics.bsplines import Array
from stages.numerics.compiled import inlined, kernel


class Cells(NamedTuple):
    """Arrays over points that the compiled loops advance in place.

    ``potential`` mV; ``states`` of the cell model, shape ``(variable, point)``; ``stress`` kPa;
    ``ionic`` I_ion/C_m at the newest level, mV/ms.
    """

    potential: Array
    states: Array
    stress: Array
    ionic: Array


class Reaction(NamedTuple):
    """Compiled loops over all cells for one pair of models; all change ``cells`` in place.

    Attributes
    ----------
    advance
        ``advance(cells, new_potential, step, cell, tension)``: states and stress (eqs. 10, 11) over
        one step of ``step`` ms with the potential running linearly from ``cells.potential`` to
        ``new_potential`` (a frozen one would be first order only). Writes I_ion/C_m at the new time
        and takes over the new potential.
    react
        ``react(cells, applied, step, substeps, cell, tension)``: potential, states and stress together
        over ``step`` ms in ``substeps`` equal parts, dv/dt = applied - I_ion/C_m without diffusion;
        ``applied`` in mV/ms, shape ``(point,)``, constant over the step. ``cells.ionic`` stays
        as it is.
    excite
        The same for potential and states alone.
    contract
        ``contract(cells, before, step, substeps, tension)``: the stress alone over ``step`` ms in
        ``substeps`` equal parts, the potential running linearly from ``before`` to
        ``cells.potential``. It acts on nothing else, so that it may follow when both are known.

    ``cell`` and ``tension`` are the constants of the two models.
    """

    advance: Callable[..., None]
    react: Callable[..., None]
    excite: Callable[..., None]
    contract: Callable[..., None]


def compile_reaction(cell_model: CellModel, tension_law: TensionLaw) -> Reaction:
    """Compiled loops over cells; one :class:`Reaction` per pair of models, each compiled on first use."""
    equations, law = equations_of(cell_model), equation_of(tension_law)
    return _compile(
        equations.ionic_current,
        equations.state_rates,
        len(cell_model.initial_states()),
        law.relaxation if tension_law.linear else law.tension_rate,
        tension_law.linear,
    )


Stress = tuple[Callable[..., Any], Callable[..., float]]
"""What a potential means for the stress (evaluated once per potential), and the rate that follows."""


@functools.cache
def _compile(
    current: Callable[..., float],
    rates: Callable[..., tuple[float, ...]],
    variables: int,
    law: Callable[..., Any],
    linear: bool,
) -> Reaction:
    ionic_current, state_rates = inlined(current, True), inlined(rates, True)
    load, store, moved, weighted = tuple_functions(variables)
    prepared, stress_rate = _linear_stress(law) if linear else _any_stress(law)

    @kernel
    def advance(cells: Any, new_potential: Any, step: float, cell: Any, tension: Any) -> None:
        v_old, states, stress, ionic = cells
        half = 0.5 * step
        for i in range(v_old.size):
            v0, v1 = v_old[i], new_potential[i]
            vm = 0.5 * (v0 + v1)
            c0, cm, c1 = prepared(v0, tension), prepared(vm, tension), prepared(v1, tension)
            s0, y0 = load(states, i), stress[i]
            ks1 = state_rates(v0, s0, cell)
            ky1 = stress_rate(c0, y0, tension)
            ks2 = state_rates(vm, moved(s0, half, ks1), cell)
            ky2 = stress_rate(cm, y0 + half * ky1, tension)
            ks3 = state_rates(vm, moved(s0, half, ks2), cell)
            ky3 = stress_rate(cm, y0 + half * ky2, tension)
            ks4 = state_rates(v1, moved(s0, step, ks3), cell)
            ky4 = stress_rate(c1, y0 + step * ky3, tension)
            s1 = weighted(s0, step, ks1, ks2, ks3, ks4)
            store(states, i, s1)
            stress[i] = y0 + step / 6.0 * (ky1 + 2.0 * (ky2 + ky3) + ky4)
            ionic[i] = ionic_current(v1, s1, cell)
            v_old[i] = v1

    @kernel
    def contract(cells: Any, before: Any, step: float, substeps: int, tension: Any) -> None:
        potential, stress = cells.potential, cells.stress
        h, part = step / substeps, 1.0 / substeps
        half = 0.5 * h
        for k in range(substeps):
            for i in range(potential.size):
                y0, change = stress[i], part * (potential[i] - before[i])
                v0 = before[i] + k * change
                c0 = prepared(v0, tension)
                cm = prepared(v0 + 0.5 * change, tension)
                c1 = prepared(v0 + change, tension)
                ky1 = stress_rate(c0, y0, tension)
                ky2 = stress_rate(cm, y0 + half * ky1, tension)
                ky3 = stress_rate(cm, y0 + half * ky2, tension)
                ky4 = stress_rate(c1, y0 + h * ky3, tension)
                stress[i] = y0 + h / 6.0 * (ky1 + 2.0 * (ky2 + ky3) + ky4)

    return Reaction(
        advance,
        _reacting(ionic_current, state_rates, variables, (prepared, stress_rate)),
        _reacting(ionic_current, state_rates, variables, NO_STRESS),
        contract,
    )


def _reacting(
    ionic_current: Callable[..., float],
    state_rates: Callable[..., tuple[float, ...]],
    variables: int,
    of_stress: Stress,
) -> Callable[..., None]:
    """Runge-Kutta 4 for potential, states and stress together."""
    load, store, moved, weighted = tuple_functions(variables)
    prepared, stress_rate = of_stress

    @kernel
    def react(
        cells: Any, applied: Any, step: float, substeps: int, cell: Any, tension: Any
    ) -> None:
        potential, states, stress = cells.potential, cells.states, cells.stress
        h = step / substeps
        half = 0.5 * h
        for _ in range(substeps):
            for i in range(potential.size):
                on = applied[i]
                v0, s0, y0 = potential[i], load(states, i), stress[i]
                kv1 = on - ionic_current(v0, s0, cell)
                ks1 = state_rates(v0, s0, cell)
                ky1 = stress_rate(prepared(v0, tension), y0, tension)
                v, s = v0 + half * kv1, moved(s0, half, ks1)
                kv2 = on - ionic_current(v, s, cell)
                ks2 = state_rates(v, s, cell)
                ky2 = stress_rate(prepared(v, tension), y0 + half * ky1, tension)
                v, s = v0 + half * kv2, moved(s0, half, ks2)
                kv3 = on - ionic_current(v, s, cell)
                ks3 = state_rates(v, s, cell)
                ky3 = stress_rate(prepared(v, tension), y0 + half * ky2, tension)
                v, s = v0 + h * kv3, moved(s0, h, ks3)
                kv4 = on - ionic_current(v, s, cell)
                ks4 = state_rates(v, s, cell)
                ky4 = stress_rate(prepared(v, tension), y0 + h * ky3, tension)
                potential[i] = v0 + h / 6.0 * (kv1 + 2.0 * (kv2 + kv3) + kv4)
                store(states, i, weighted(s0, h, ks1, ks2, ks3, ks4))
                stress[i] = y0 + h / 6.0 * (ky1 + 2.0 * (ky2 + ky3) + ky4)

    return react


def _linear_stress(law: Callable[..., Any]) -> Stress:
    """Rate and target once per potential, as many stresses as are asked for."""
    relaxation = inlined(law, True)

    @inlined
    def stress_rate(coefficients: Any, sigma: float, tension: Any) -> float:
        rate, target = coefficients
        return rate * (target - sigma)

    return relaxation, stress_rate


def _any_stress(law: Callable[..., Any]) -> Stress:
    """The whole law at every stress."""

    @inlined
    def potential_itself(v: float, tension: Any) -> float:
        return v

    return potential_itself, inlined(law, True)


@inlined
def _nothing(v: float, tension: Any) -> float:
    return 0.0


@inlined
def _still(nothing: float, sigma: float, tension: Any) -> float:
    return 0.0


NO_STRESS: Stress = (_nothing, _still)
"""Leaves the stress as it is; what is multiplied by zero here costs nothing."""
