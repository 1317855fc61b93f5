"""A cell without diffusion: its response to applied currents, as a trace in time."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from stages.electrophysiology.cell_config import CellConfig
from stages.electrophysiology.cell_models.base import equations_of
from stages.electrophysiology.pulse_train import PulseTrain
from stages.electrophysiology.reaction import Cells, compile_reaction
from stages.electrophysiology.tension_laws.base import tension_rate
from stages.numerics.bsplines import Array
from stages.numerics.compiled import kernel


class Pulse(NamedTuple):
    """Applied current over capacitance, ``rate`` in mV/ms, from ``start`` for ``duration`` ms."""

    start: float
    duration: float
    rate: float

    @property
    def course(self) -> PulseTrain:
        """When it is on."""
        return PulseTrain((self.start,), self.duration)


class CellState(NamedTuple):
    """Potential in mV, states of the cell model, active stress in kPa."""

    potential: float
    states: tuple[float, ...]
    stress: float


@dataclass(frozen=True)
class Trace:
    """What one cell did.

    Attributes
    ----------
    time
        ms, shape ``(time,)``; every begin and end of a pulse is among them.
    potential, stress
        mV and kPa, shape ``(time,)``.
    states
        Variables of the cell model, shape ``(variable, time)``.
    """

    time: Array
    potential: Array
    states: Array
    stress: Array

    def state(self, index: int = -1) -> CellState:
        """State at one of the times: what another trace may start from."""
        return CellState(
            float(self.potential[index]),
            tuple(self.states[:, index].tolist()),
            float(self.stress[index]),
        )


def rest(config: CellConfig) -> CellState:
    """The state from which cells start: initial potential, no active stress."""
    return CellState(config.initial_potential, config.cell_model.initial_states(), 0.0)


def follow(
    config: CellConfig,
    pulses: Sequence[Pulse],
    duration: float,
    step: float,
    start: CellState | None = None,
) -> Trace:
    """Response of a cell by Runge-Kutta 4 in potential, states and stress together.

    Parameters
    ----------
    config
        Cell model and tension law.
    pulses
        Currents; where they overlap they add up.
    duration
        Simulated time from 0, ms.
    step
        Longest time step, ms. Every stretch between begins and ends of pulses is cut into equal steps,
        so that no step sees a jump: the order is four.
    start
        State at time 0; rest, if none is given.
    """
    time = _instants(pulses, duration, step)
    lengths = np.diff(time)
    applied = mean_rates(pulses, time)
    trace, cells = _begun(time, start or rest(config), config)
    constants = config.cell_model.constants(), config.tension_law.constants()
    react = compile_reaction(config.cell_model, config.tension_law).react
    _recorder(react)(cells, applied, lengths, trace, *constants)
    return Trace(time, *trace)


def follow_as_published(
    config: CellConfig, pulses: Sequence[Pulse], duration: float, steps: int, mean: bool = False
) -> Trace:
    """The same in equal steps by the scheme of the paper without diffusion (sec. 3.4).

    The potential advances by Adams-Bashforth 2, states and stress by Runge-Kutta 4. A pulse is on for
    start < t <= stop and enters with the mean of both levels of a step, as in eq. 84, which delays it by
    half a step; with ``mean`` it enters with its exact mean over the step.
    """
    time: Array = np.arange(steps + 1, dtype=float) * (duration / steps)
    if mean:
        applied = mean_rates(pulses, time)
    else:
        levels = np.zeros(time.size)
        for pulse in pulses:
            levels += pulse.rate * pulse.course.amplitude(time)
        applied = 0.5 * (levels[:-1] + levels[1:])
    trace, cells = _begun(time, rest(config), config)
    constants = config.cell_model.constants(), config.tension_law.constants()
    advance = compile_reaction(config.cell_model, config.tension_law).advance
    _published_recorder(advance)(cells, applied, duration / steps, trace, *constants)
    return Trace(time, *trace)


def plain_rates(config: CellConfig) -> Callable[[Array, float], Array]:
    """The equations in plain Python, for other integrators.

    The function takes (potential, states, stress) as one array and the applied current over
    capacitance in mV/ms, and returns the rates in the same order.
    """
    cell, equations = config.cell_model.constants(), equations_of(config.cell_model)

    def rates(y: Array, applied: float) -> Array:
        v, s, sigma = float(y[0]), tuple(y[1:-1].tolist()), float(y[-1])
        return np.array(
            [
                applied - equations.ionic_current(v, s, cell),
                *equations.state_rates(v, s, cell),
                tension_rate(config.tension_law, v, sigma),
            ]
        )

    return rates


def mean_rates(pulses: Sequence[Pulse], time: Array) -> Array:
    """Exact mean of the applied rate over each step, mV/ms, shape ``(time - 1,)``.

    Examples
    --------
    >>> mean_rates([Pulse(1.0, 2.0, 20.0)], np.array([0.0, 1.5, 2.0, 4.0])).round(12).tolist()
    [6.666666666667, 20.0, 10.0]
    """
    total = np.zeros(time.size - 1)
    for pulse in pulses:
        total += pulse.rate * pulse.course.mean(time[:-1], time[1:])
    return total


def _instants(pulses: Sequence[Pulse], duration: float, step: float) -> Array:
    """Ends of the steps: equal ones between begins and ends of pulses."""
    edges = {0.0, duration}
    for pulse in pulses:
        edges |= {pulse.start, pulse.start + pulse.duration}
    kept = np.array(sorted(edge for edge in edges if 0.0 <= edge <= duration))
    kept = kept[np.append(np.diff(kept) > 1e-9, True)]  # begins and ends may agree up to rounding
    parts = [np.zeros(1)]
    for low, high in itertools.pairwise(kept):
        count = max(int(np.ceil((high - low) / step - 1e-9)), 1)
        parts.append(low + (high - low) * np.arange(1, count + 1) / count)
    return np.concatenate(parts)


def _begun(
    time: Array, start: CellState, config: CellConfig
) -> tuple[tuple[Array, Array, Array], Cells]:
    """Room for potential, states and stress over time with the start filled in; the cell's arrays."""
    states = np.reshape(np.asarray(start.states, dtype=float), (-1, 1))
    current = equations_of(config.cell_model).ionic_current(
        start.potential, start.states, config.cell_model.constants()
    )
    cells = Cells(
        potential=np.array([start.potential]),
        states=states.copy(),
        stress=np.array([start.stress]),
        ionic=np.array([current]),
    )
    trace = (np.empty(time.size), np.empty((states.shape[0], time.size)), np.empty(time.size))
    trace[0][0], trace[2][0] = start.potential, start.stress
    trace[1][:, 0] = states[:, 0]
    return trace, cells


@kernel
def _store(cells: Any, trace: Any, k: int) -> None:
    potential, states, stress = trace
    potential[k], stress[k] = cells.potential[0], cells.stress[0]
    for variable in range(states.shape[0]):
        states[variable, k] = cells.states[variable, 0]


@functools.cache
def _recorder(react: Callable[..., None]) -> Callable[..., None]:
    """Compiled loop over steps of ``react``."""

    @kernel
    def record(cells: Any, applied: Any, lengths: Any, trace: Any, cell: Any, tension: Any) -> None:
        for k in range(applied.size):
            react(cells, applied[k : k + 1], lengths[k], 1, cell, tension)
            _store(cells, trace, k + 1)

    return record


@functools.cache
def _published_recorder(advance: Callable[..., None]) -> Callable[..., None]:
    """Compiled loop over steps of Adams-Bashforth 2 and ``advance``."""

    @kernel
    def record(cells: Any, applied: Any, step: float, trace: Any, cell: Any, tension: Any) -> None:
        new = np.empty(1)
        before = cells.ionic[0]
        for k in range(applied.size):
            now = cells.ionic[0]
            slope = applied[k] - (1.5 * now - 0.5 * before if k > 0 else now)
            new[0] = cells.potential[0] + step * slope
            before = now
            advance(cells, new, step, cell, tension)
            _store(cells, trace, k + 1)

    return record
