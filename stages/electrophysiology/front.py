"""The front that a resting tissue carries: its speed, width and time, before anything is simulated.

A plane front v(x - c t) with the other variables still at rest obeys -c v' = D v'' + f(v), where
f = -I_ion/C_m. With q = -dv/dx as a function of v this is

    dq/dv = c/D - f(v)/(D q),    q = 0 at rest and at the excited potential,

which only one speed c fulfils: a slower front turns back before it arrives, a faster one overshoots.
Plain Python without NumPy: configurations are checked with it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from stages.electrophysiology.cell_models.base import CellModel, equations_of

if TYPE_CHECKING:
    from stages.electrophysiology.config import ElectrophysiologyConfig

HIGHEST = 300.0
"""mV above rest: no excited potential lies beyond."""
SCAN = 600
"""Intervals in which the excited potential is looked for."""
INTERVALS = 300
"""Steps of the integration from rest to the excited potential."""
REMEMBERED = 1000
"""Cells whose fronts are remembered: a sweep checks thousands of tissues that are made of the same ones."""


@dataclass(frozen=True)
class Front:
    """A plane front in a resting tissue.

    Attributes
    ----------
    speed
        mm/ms.
    width
        Distance over which the potential rises from 10 to 90 % of its height, mm.
    """

    speed: float
    width: float

    @property
    def rise_time(self) -> float:
        """Time in which the front passes a point, 10 to 90 %, ms."""
        return self.width / self.speed

    def in_tissue(self, diffusivity: float) -> Front:
        """The same cells' front for D/C_m = ``diffusivity``, mm^2/ms, where this one is for 1 mm^2/ms."""
        scale = math.sqrt(diffusivity)
        return Front(self.speed * scale, self.width * scale)


def tissue_front(config: ElectrophysiologyConfig) -> Front | None:
    """Front of the configured tissue at rest; none where it carries none.

    Where it conducts better along its fibres, the front that runs across them: the slowest, and the
    thinnest one. A model with gates that close during the upstroke has a somewhat slower front than
    this, since gates stay open here. Widths of simulated fronts differ by 0.2 % (Aliev-Panfilov), 1 %
    (Mitchell-Schaeffer), 2 % (FitzHugh-Nagumo), and are 7 to 13 % larger for Bueno-Orovio, whose fast gate
    closes in the upstroke.
    """
    front = _cell_front(config.cell_model, config.initial_potential)
    conductivity = min(config.conductivity, config.transverse_conductivity or math.inf)
    return front and front.in_tissue(conductivity / config.membrane_capacitance)


@lru_cache(maxsize=REMEMBERED)
def _cell_front(model: CellModel, rest: float) -> Front | None:
    """Front for D/C_m = 1 mm^2/ms."""
    equations = equations_of(model)
    states, constants = model.initial_states(), model.constants()
    return plane_front(lambda v: equations.ionic_current(v, states, constants), rest, 1.0)


def plane_front(current: Callable[[float], float], rest: float, diffusivity: float) -> Front | None:
    """Front of a tissue whose variables other than v stay at rest; none where it carries no front.

    Parameters
    ----------
    current
        I_ion/C_m in mV/ms of the potential in mV, outward positive.
    rest
        Potential at rest, mV.
    diffusivity
        D/C_m, mm^2/ms.

    Examples
    --------
    A cubic current -k u (u - a)(1 - u) in u = v/100 carries a logistic front with the speed
    sqrt(k D/2) (1 - 2 a) and the width 2 ln 9 sqrt(2 D/k).

    >>> front = plane_front(lambda v: -0.62e-4 * v * (v - 15.0) * (100.0 - v), 0.0, 0.002)
    >>> exact = math.sqrt(0.62 * 0.002 / 2) * 0.7, 4 * math.log(3) * math.sqrt(0.004 / 0.62)
    >>> round(front.speed / exact[0], 4), round(front.width / exact[1], 3)
    (1.0, 1.0)
    """
    excited = _excited(current, rest)
    if excited is None:
        return None
    dv = (excited - rest) / INTERVALS
    halves = [-current(rest + 0.5 * dv * i) for i in range(2 * INTERVALS + 1)]
    slope = (halves[1] - halves[0]) / (0.5 * dv)
    low, high = 0.0, 2.0 * math.sqrt(_steepest(halves, 0.5 * dv))
    if _climb(0.0, halves, dv, slope) is not None:
        return None  # even a front at rest arrives: the tissue is excited by itself, or never
    for _ in range(40):
        speed = 0.5 * (low + high)
        if _climb(speed, halves, dv, slope) is None:
            low = speed
        else:
            high = speed
    climbed = _climb(high, halves, dv, slope)
    assert climbed is not None
    inside = climbed[INTERVALS // 10 : INTERVALS - INTERVALS // 10 + 1]
    width = sum(0.5 * dv * (1 / a + 1 / b) for a, b in itertools.pairwise(inside))
    return Front(high, width).in_tissue(diffusivity)


def _excited(current: Callable[[float], float], rest: float) -> float | None:
    """Stable potential above the threshold, where the current turns outward again."""
    step = HIGHEST / SCAN
    inward = False
    for i in range(1, SCAN + 1):
        v = rest + i * step
        if current(v) < 0.0:
            inward = True
        elif inward:
            low, high = v - step, v
            for _ in range(40):
                middle = 0.5 * (low + high)
                low, high = (middle, high) if current(middle) < 0.0 else (low, middle)
            return 0.5 * (low + high)
    return None


def _steepest(rates: list[float], dv: float) -> float:
    """Largest f/(v - rest): no front is faster than 2 sqrt(D times that) (Aronson and Weinberger)."""
    return max(f / (i * dv) for i, f in enumerate(rates) if i)


def _climb(speed: float, rates: list[float], dv: float, slope: float) -> list[float] | None:
    """q at each potential from rest up, for D = 1; none where the front turns back."""
    q = dv * 0.5 * (speed + math.sqrt(max(speed * speed - 4.0 * slope, 0.0)))
    if q <= 0.0:
        return None
    found = [0.0, q]
    for i in range(1, INTERVALS):
        f0, fm, f1 = rates[2 * i], rates[2 * i + 1], rates[2 * i + 2]
        k1 = speed - f0 / q
        middle = q + 0.5 * dv * k1
        if middle <= 0.0:
            return None
        k2 = speed - fm / middle
        middle = q + 0.5 * dv * k2
        if middle <= 0.0:
            return None
        k3 = speed - fm / middle
        end = q + dv * k3
        if end <= 0.0:
            return None
        q += dv / 6.0 * (k1 + 2.0 * (k2 + k3) + speed - f1 / end)
        if q <= 0.0:
            return None
        found.append(q)
    return found
