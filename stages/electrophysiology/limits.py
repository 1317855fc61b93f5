"""What a cell model demands of mesh and time step, estimated before anything is computed.

Plain Python on the model's own functions, quick enough for reading a configuration.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

from stages.electrophysiology.cell_models.base import CellEquations, CellModel, equations_of
from stages.electrophysiology.tension_laws.base import TensionLaw, tension_rate

if TYPE_CHECKING:
    from stages.electrophysiology.cell_config import CellConfig
    from stages.electrophysiology.config import ElectrophysiologyConfig

HIGHEST = 250.0
"""mV above rest up to which the peak of the action potential is looked for."""

LONGEST = 1000.0
"""ms for which an action potential is followed at most."""

REMEMBERED = 1000
"""Cells whose estimates are remembered: a sweep checks thousands of tissues that are made of the same ones."""


class Excitation(NamedTuple):
    """Upstroke of a cell whose gates are still as at rest.

    Attributes
    ----------
    start, peak
        Potential at rest, and the highest one that the inward current drives at, mV.
    steepest
        Potential at which the inward current is largest, mV.
    rate
        That current over C_m, relative to the range peak - start, 1/ms.
    """

    start: float
    peak: float
    steepest: float
    rate: float


def excitation(config: CellConfig) -> Excitation | None:
    """Upstroke of the cells of a tissue; None if there is no inward current above rest."""
    return _excitation(config.cell_model, config.initial_potential)


@lru_cache(maxsize=REMEMBERED)
def _excitation(model: CellModel, start: float) -> Excitation | None:
    equations, states, constants = equations_of(model), model.initial_states(), model.constants()
    levels = [start + 0.5 * i for i in range(1, int(2 * HIGHEST) + 1)]
    inward = [-equations.ionic_current(v, states, constants) for v in levels]
    rising = [v for v, rate in zip(levels, inward, strict=True) if rate > 0.0]
    if not rising:
        return None
    largest = max(inward)
    return Excitation(
        start, rising[-1], levels[inward.index(largest)], largest / (rising[-1] - start)
    )


class Decay(NamedTuple):
    """Fastest decay of small deviations along an action potential, 1/ms.

    Attributes
    ----------
    potential
        Largest d(I_ion/C_m)/dv: of the potential, with the gates held.
    states
        Of any gate, with the potential held.
    stress
        Of the active stress.
    """

    potential: float
    states: float
    stress: float


def decay(config: CellConfig) -> Decay:
    """Fastest decay along the action potential of a single cell that starts with the steepest upstroke.

    The midpoint rule with steps of at most 2 mV and half a decay time; for cells without an inward current
    the state at rest alone.
    """
    return _decay(config.cell_model, config.tension_law, config.initial_potential)


@lru_cache(maxsize=REMEMBERED)
def _decay(model: CellModel, law: TensionLaw, start: float) -> Decay:
    equations, constants = equations_of(model), model.constants()

    def rates(y: tuple[float, ...]) -> tuple[float, ...]:
        return (
            -equations.ionic_current(y[0], y[1:], constants),
            *equations.state_rates(y[0], y[1:], constants),
        )

    def moved(y: tuple[float, ...], step: float, k: tuple[float, ...]) -> tuple[float, ...]:
        return tuple([a + step * b for a, b in zip(y, k, strict=True)])

    y = (start, *model.initial_states())
    slopes = _decay_at(equations, constants, y, rates(y))
    fastest = Decay(slopes[0], max(slopes[1:], default=0.0), _stress_decay(law, y[0]))
    found = _excitation(model, start)
    if found is None:
        return fastest
    y, time = (found.steepest, *y[1:]), 0.0
    repolarised = found.start + 0.1 * (found.peak - found.start)
    while y[0] > repolarised and time < LONGEST:
        k = rates(y)
        slopes = _decay_at(equations, constants, y, k)
        fastest = Decay(
            max(fastest.potential, slopes[0]),
            max(fastest.states, max(slopes[1:], default=0.0)),
            max(fastest.stress, _stress_decay(law, y[0])),
        )
        step = min(2.0 / max(abs(k[0]), 1e-9), 0.5 / max(*slopes, 0.1))
        y, time = moved(y, step, rates(moved(y, 0.5 * step, k))), time + step
    return fastest


def n_steps_needed(config: ElectrophysiologyConfig) -> int | None:
    """Number of steps with which the explicit part of the scheme would be stable; None if it is.

    The scheme says how long a step may be for the fastest decays of the cells.
    """
    longest = config.scheme.longest_step(decay(config))
    return None if config.step <= longest else math.ceil(config.duration / longest)


def _decay_at(
    equations: CellEquations, constants: Any, y: tuple[float, ...], k: tuple[float, ...]
) -> list[float]:
    """-d(dy_i/dt)/dy_i of potential and gates; the smaller of both sides, which skips switches.

    ``k`` are the rates dy/dt.
    """
    v, gates = y[0], y[1:]
    by = 1e-3
    upper = -equations.ionic_current(v + by, gates, constants)
    lower = -equations.ionic_current(v - by, gates, constants)
    found = [min((k[0] - upper) / by, (lower - k[0]) / by)]
    by = 1e-6
    for i, (gate, rate) in enumerate(zip(gates, k[1:], strict=True)):
        before, after = gates[:i], gates[i + 1 :]
        upper = equations.state_rates(v, (*before, gate + by, *after), constants)[i]
        lower = equations.state_rates(v, (*before, gate - by, *after), constants)[i]
        found.append(min((rate - upper) / by, (lower - rate) / by))
    return found


def _stress_decay(law: TensionLaw, v: float) -> float:
    """-d(rate)/d(sigma) at a potential."""
    return tension_rate(law, v, 0.0) - tension_rate(law, v, 1.0)
