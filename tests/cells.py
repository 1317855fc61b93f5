"""Cells with the parameter sets that ship."""

from __future__ import annotations

import itertools
import sys
from types import ModuleType
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from pipeline.config import load, read_toml
from stages.electrophysiology.cell_config import CellConfig
from stages.electrophysiology.single_cell import CellState, Pulse, Trace, plain_rates
from stages.numerics.bsplines import Array
from workflows.registry import parameter_files

LIBRARY: dict[str, Any] = next(
    read_toml(file)["electrophysiology"]
    for file in parameter_files("planar-waves")
    if file.name == "cells.toml"
)
CELL_MODELS = tuple(LIBRARY["cell_models"])
TENSION_LAWS = tuple(LIBRARY["tension_laws"])


def cells(cell_model: str, tension_law: str = "goektepe-kuhl", *overrides: str) -> CellConfig:
    """Cells by the names of their sets."""
    chosen = {"cell_model": cell_model, "tension_law": tension_law}
    return load(CellConfig, [LIBRARY, chosen], overrides)


def module_of(model: object) -> ModuleType:
    """The file that a model is defined in, with its equations."""
    return sys.modules[type(model).__module__]


def slope(config: CellConfig, y: Array, applied: float) -> Array:
    """d/dt of (potential, states, stress) by the plain functions of the models."""
    return plain_rates(config)(y, applied)


def integrated(
    config: CellConfig, start: CellState, pulse: Pulse, time: Array, **settings: Any
) -> Trace:
    """Reference by SciPy, begun anew at each jump of the applied current."""
    y, rows, done = np.array([start.potential, *start.states, start.stress]), [], 0.0
    edges = [0.0, pulse.start, pulse.start + pulse.duration, time[-1]]
    for low, high in itertools.pairwise(edges):
        on = pulse.rate if low == pulse.start else 0.0
        wanted = time[(time > done) & (time <= high)]
        found = solve_ivp(
            lambda t, y, on=on: slope(config, y, on),
            (low, high),
            y,
            t_eval=np.unique(np.append(wanted, high)),
            **settings,
        )
        rows += list(found.y.T[: wanted.size])
        y, done = found.y[:, -1], high
    table = np.array([[start.potential, *start.states, start.stress], *rows]).T
    return Trace(time, table[0], table[1:-1], table[-1])
