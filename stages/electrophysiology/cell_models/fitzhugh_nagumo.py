"""FitzHugh-Nagumo cell model as modified for the heart: no undershoot after the action potential.

References
----------
J. M. Rogers, A. D. McCulloch, A collocation-Galerkin finite element model of cardiac action potential
propagation, IEEE Transactions on Biomedical Engineering 41 (1994) 743-757: the recovery current is
proportional to the potential above rest. J. Sundnes et al., Computing the Electrical Activity in the
Heart, Springer (2006), sec. 2.4.1: the same in mV and ms, used here.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from stages.configuration import quantity
from stages.electrophysiology.cell_models.base import CellModel

SOURCE = "Sundnes et al. (2006), sec. 2.4.1"


class Constants(NamedTuple):
    """Potentials in mV, rates in 1/ms."""

    a: float
    b: float
    c_1: float
    c_2: float
    c_3: float
    scale: float
    rest: float


class FitzHughNagumo(CellModel):
    """du/dt = c_1 u (u - a)(1 - u) - c_2 u w, dw/dt = b (u - c_3 w).

    u = (v - potential_rest)/potential_range; w is the recovery variable over potential_range, so that
    both are of the order of one.
    """

    name: Literal["fitzhugh-nagumo"] = "fitzhugh-nagumo"
    a: float = quantity("", "excitation threshold a, as u", SOURCE, gt=0, lt=1)
    b: float = quantity("1/ms", "rate of recovery b", SOURCE, gt=0)
    c_1: float = quantity("1/ms", "rate of excitation c_1", SOURCE, gt=0)
    c_2: float = quantity("1/ms", "rate of the recovery current c_2", SOURCE, ge=0)
    c_3: float = quantity("", "decay of recovery c_3", SOURCE, ge=0)
    potential_range: float = quantity("mV", "v_peak - v_rest", SOURCE, gt=0)
    potential_rest: float = quantity("mV", "potential at rest v_rest", SOURCE)
    initial_recovery: float = quantity("", "recovery variable w at the start", SOURCE)

    def constants(self) -> Constants:
        """Parameters as the equations read them."""
        return Constants(
            self.a,
            self.b,
            self.c_1,
            self.c_2,
            self.c_3,
            self.potential_range,
            self.potential_rest,
        )

    def initial_states(self) -> tuple[float]:
        """The recovery variable w."""
        return (self.initial_recovery,)

    def rest_potential(self) -> float:
        """u = 0, mV."""
        return self.potential_rest


def ionic_current(v: float, s: tuple[float], p: Constants) -> float:
    """I_ion / C_m = potential_range (c_2 u w - c_1 u (u - a)(1 - u)), mV/ms.

    Examples
    --------
    >>> p = Constants(0.13, 0.013, 0.26, 0.1, 1.0, 125.0, -85.0)
    >>> ionic_current(-85.0, (0.0,), p)  # rest
    0.0
    >>> round(ionic_current(-22.5, (0.2,), p), 9)  # 125 (0.1 * 0.5 * 0.2 - 0.26 * 0.5 * 0.37 * 0.5)
    -1.75625
    """
    (w,) = s
    u = (v - p.rest) / p.scale
    return p.scale * (p.c_2 * u * w - p.c_1 * u * (u - p.a) * (1.0 - u))


def state_rates(v: float, s: tuple[float], p: Constants) -> tuple[float]:
    """dw/dt = b (u - c_3 w), 1/ms.

    Examples
    --------
    >>> p = Constants(0.13, 0.013, 0.26, 0.1, 1.0, 125.0, -85.0)
    >>> round(state_rates(-22.5, (0.2,), p)[0], 12)  # 0.013 (0.5 - 0.2)
    0.0039
    """
    (w,) = s
    return (p.b * ((v - p.rest) / p.scale - p.c_3 * w),)


MODEL = FitzHughNagumo
