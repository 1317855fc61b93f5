"""What a cell model demands of mesh and time step, estimated before anything is computed.

Plain Python on the model's own functions, quick enough for reading a configuration.
"""

from __future__ import annotations

import math
import sys
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from stages.electrophysiology.config import ElectrophysiologyConfig

HIGHEST = 250.0
"""mV above rest up to which the peak of the action potential is looked for."""

WIDTH = 2.2
"""Front width over sqrt(D / (C_m rate)). Simulated fronts have 2.11 (Aliev-Panfilov and FitzHugh-Nagumo; for the cubic
in closed form 2 ln 9 sqrt(2 rate / k), with rate = 0.1155 k at a = 0.15), 2.38 (threshold 0.01), 2.31 (Mitchell-Schaeffer),
2.52 to 2.65 (Bueno-Orovio)."""


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


def excitation(config: ElectrophysiologyConfig) -> Excitation | None:
    """Upstroke of the cells of a tissue; None if there is no inward current above rest."""
    model, start = config.cell_model, config.initial_potential
    current = sys.modules[type(model).__module__].ionic_current
    states, constants = model.initial_states(), model.constants()
    levels = [start + 0.5 * i for i in range(1, int(2 * HIGHEST) + 1)]
    inward = [-float(current(v, states, constants)) for v in levels]
    rising = [v for v, rate in zip(levels, inward, strict=True) if rate > 0.0]
    if not rising:
        return None
    largest = max(inward)
    return Excitation(
        start, rising[-1], levels[inward.index(largest)], largest / (rising[-1] - start)
    )


def front_width(config: ElectrophysiologyConfig) -> float | None:
    """Estimated distance over which the potential of a front rises from 10 to 90 % of its range, mm.

    Within 20 % of simulated fronts. Where conduction differs with direction, the narrower front counts. None for
    cells that carry no front.
    """
    found = excitation(config)
    if found is None:
        return None
    slowest = min(config.conductivity, config.transverse_conductivity or config.conductivity)
    return WIDTH * math.sqrt(slowest / config.membrane_capacitance / found.rate)
